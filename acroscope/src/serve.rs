//! Shows a page on the loopback interface, at a port that is free, until it is told to end.

use crate::error::Error;
use std::time::Duration;
use tiny_http::{Header, Request, Response, Server};

/// Looks so often whether it is to end.
const PATIENCE: Duration = Duration::from_millis(100);

/// Serves `html` at the address that `told` is told, until `ended` answers true.
pub fn serve(html: &str, told: impl FnOnce(&str), ended: impl Fn() -> bool) -> Result<(), Error> {
    let server = Server::http("127.0.0.1:0").map_err(|why| Error::Serve(why.to_string()))?;
    let address = server.server_addr().to_string();
    told(&format!("http://{address}/"));
    while !ended() {
        if let Some(request) = server.recv_timeout(PATIENCE).map_err(|why| Error::Serve(why.to_string()))? {
            // A browser that went away in between is no matter.
            let _ = answer(request, html, &address);
        }
    }
    Ok(())
}

fn answer(request: Request, html: &str, address: &str) -> std::io::Result<()> {
    // Another site's page may reach 127.0.0.1 by a name of its own; it doesn't get to see the run.
    let ours = request.headers().iter().any(|header| {
        header.field.equiv("Host") && (header.value == address || header.value.as_str() == local(address))
    });
    if !ours || request.url() != "/" {
        return request.respond(Response::from_string("not found\n").with_status_code(404));
    }
    let kind = Header::from_bytes("Content-Type", "text/html; charset=utf-8");
    let mut response = Response::from_string(html);
    if let Ok(kind) = kind {
        response.add_header(kind);
    }
    request.respond(response)
}

fn local(address: &str) -> String {
    address.replace("127.0.0.1", "localhost")
}

#[cfg(test)]
mod tests {
    use super::serve;
    use std::io::{Read as _, Write as _};
    use std::net::TcpStream;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::sync::mpsc;

    #[test]
    fn law_only_the_page_and_only_by_its_own_address() {
        let ended = AtomicBool::new(false);
        let (send, receive) = mpsc::channel();
        std::thread::scope(|scope| {
            let told = move |address: &str| send.send(address.to_owned()).expect("the test listens");
            scope.spawn(|| serve("<p>page</p>", told, || ended.load(Ordering::Relaxed)).expect("served"));
            let url = receive.recv().expect("told");
            let address = url.trim_start_matches("http://").trim_end_matches('/').to_owned();
            let ask = |path: &str, host: &str| {
                let mut stream = TcpStream::connect(&address).expect("listens");
                write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n")
                    .expect("asked");
                let mut answer = String::new();
                stream.read_to_string(&mut answer).expect("answered");
                answer
            };
            assert!(address.starts_with("127.0.0.1:"));
            let page = ask("/", &address);
            assert!(
                page.starts_with("HTTP/1.1 200")
                    && page.contains("text/html")
                    && page.ends_with("<p>page</p>")
            );
            assert!(ask("/", "evil.example").starts_with("HTTP/1.1 404"));
            assert!(ask("/etc/passwd", &address).starts_with("HTTP/1.1 404"));
            ended.store(true, Ordering::Relaxed);
        });
    }
}
