/* The variadic half of the logger callback: formats the message, then hands it to Rust (logger.rs). */
#include <stdarg.h>
#include <stdio.h>

struct sink { void (*line)(const void *sink, int status, const char *category, const char *text); };

void orchestrator_logger(void *environment, const char *instance, int status, const char *category,
                         const char *message, ...) {
    const struct sink *sink = environment;
    char text[4096];
    va_list arguments;
    (void)instance;
    if (!sink || !message) return;
    va_start(arguments, message);
    vsnprintf(text, sizeof text, message, arguments);
    va_end(arguments);
    sink->line(sink, status, category, text);
}
