/* The variadic half of the logger callback: formats the message, then hands it to Rust (logger.rs). Neither half reads
   what the environment points to: some units log with a pointer of their own. */
#include <stdarg.h>
#include <stdio.h>

typedef void (*receiver)(const void *environment, const void *caller, int status, const char *category, const char *text);

static receiver receive;

void orchestrator_logger_receiver(receiver with) { receive = with; }

void orchestrator_logger(void *environment, const char *instance, int status, const char *category,
                         const char *message, ...) {
    char text[4096];
    va_list arguments;
    (void)instance;
    if (!receive) return;
    if (!message) message = "(no text)";
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments);
    va_end(arguments);
#if defined(__GNUC__)
    receive(environment, __builtin_return_address(0), status, category, text);
#else
    receive(environment, 0, status, category, text);
#endif
}
