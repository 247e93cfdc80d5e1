//! The part of HTTP/1.1 that the page needs: requests and answers with a stated length, and persistent connections (RFC 9112).
//! `httparse` parses the heads.

use std::borrow::Cow;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Longest head of a request, in bytes. The number of headers has a separate limit.
const LONGEST_HEAD: usize = 16 << 10;
const MOST_HEADERS: usize = 64;
/// Longest body of a request, in bytes. A design with a thousand points needs a tenth of it.
pub(super) const LONGEST_BODY: usize = 1 << 20;
/// Time limit for the head of the first request of a connection.
const STRANGER_PATIENCE: Duration = Duration::from_secs(5);
/// Time limit for the body of a request, for writing an answer, and for the rest of a head that has begun.
const PATIENCE: Duration = Duration::from_secs(10);
/// Longest pause between two requests of a connection that has shown the token.
const IDLE: Duration = Duration::from_secs(120);

/// Head of a request.
pub(super) struct Head {
    pub method: String,
    /// Path without the query.
    pub path: String,
    pub host: Option<String>,
    pub origin: Option<String>,
    pub content_type: Option<String>,
    /// True if the client wants to send further requests on this connection.
    pub keeps: bool,
    /// Length of the request's body in bytes.
    length: usize,
}

/// Reason why no request could be read.
pub(super) enum Unread {
    /// The connection is closed, broken or too slow.
    Gone,
    /// The server refuses the request with this HTTP status and this reason.
    Refused(u16, &'static str),
}

/// A connection that delivers requests one after the other.
pub(super) struct Connection {
    stream: TcpStream,
    /// Bytes that were read but not yet used.
    ahead: Vec<u8>,
    /// True if an earlier request has shown the token.
    is_admitted: bool,
}

impl Connection {
    pub(super) fn new(stream: TcpStream) -> std::io::Result<Self> {
        // Answers are written in one piece, so waiting for more data would only cause a delay.
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(PATIENCE))?;
        Ok(Connection {
            stream,
            ahead: Vec::new(),
            is_admitted: false,
        })
    }

    /// Switches to the longer time limit of connections that have shown the token.
    pub(super) fn admit(&mut self) {
        self.is_admitted = true;
    }

    /// Reads the head of the next request.
    pub(super) fn head(&mut self) -> Result<Head, Unread> {
        let mut begun = !self.is_admitted;
        let first = if begun { STRANGER_PATIENCE } else { IDLE };
        let mut deadline = Instant::now() + first;
        loop {
            if !self.ahead.is_empty() {
                if !begun {
                    begun = true;
                    deadline = Instant::now() + PATIENCE;
                }
                if let Some((head, used)) = parsed(&self.ahead)? {
                    self.ahead.drain(..used);
                    return Ok(head);
                }
                if self.ahead.len() > LONGEST_HEAD {
                    return Err(Unread::Refused(431, "the head of the request is too long"));
                }
            }
            self.more(deadline)?;
        }
    }

    /// Reads the body that belongs to a head. The only error is [`Unread::Gone`].
    pub(super) fn body(&mut self, head: &Head) -> Result<Vec<u8>, Unread> {
        let deadline = Instant::now() + PATIENCE;
        while self.ahead.len() < head.length {
            self.more(deadline)?;
        }
        let rest = self.ahead.split_off(head.length);
        Ok(std::mem::replace(&mut self.ahead, rest))
    }

    fn more(&mut self, deadline: Instant) -> Result<(), Unread> {
        let mut piece = [0; 16 << 10];
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || self.stream.set_read_timeout(Some(left)).is_err() {
                return Err(Unread::Gone);
            }
            match self.stream.read(&mut piece) {
                Ok(0) => return Err(Unread::Gone),
                Ok(count) => {
                    self.ahead.extend_from_slice(&piece[..count]);
                    return Ok(());
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(_) => return Err(Unread::Gone),
            }
        }
    }

    pub(super) fn answer(&mut self, response: &Response, keeps: bool) -> std::io::Result<()> {
        self.stream.write_all(&response.bytes(keeps))
    }
}

/// Parses the head of a request at the start of `bytes`. Returns the head with its length in bytes, or `None` if the head is not
/// complete.
fn parsed(bytes: &[u8]) -> Result<Option<(Head, usize)>, Unread> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let used = match request.parse(bytes) {
        Ok(httparse::Status::Complete(used)) => used,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => {
            return Err(Unread::Refused(431, "there are too many headers"));
        }
        Err(_) => return Err(Unread::Refused(400, "not a request of HTTP/1.1")),
    };
    let refused = |why| Err(Unread::Refused(400, why));
    let mut head = Head {
        method: request.method.unwrap_or_default().to_owned(),
        path: request.path.unwrap_or_default().to_owned(),
        host: None,
        origin: None,
        content_type: None,
        keeps: request.version == Some(1),
        length: 0,
    };
    if let Some(end) = head.path.find('?') {
        head.path.truncate(end);
    }
    let mut length = None;
    for header in request.headers.iter() {
        let Ok(value) = std::str::from_utf8(header.value) else {
            return refused("a header is not text");
        };
        let place = match header.name.to_ascii_lowercase().as_str() {
            "host" => &mut head.host,
            "origin" => &mut head.origin,
            "content-type" => &mut head.content_type,
            "content-length" => &mut length,
            "transfer-encoding" => {
                return Err(Unread::Refused(
                    501,
                    "a body needs a length and must not be in chunks",
                ));
            }
            "connection" => {
                head.keeps &= !value.to_ascii_lowercase().contains("close");
                continue;
            }
            _ => continue,
        };
        if place.replace(value.trim().to_owned()).is_some() {
            return refused("a header occurs twice");
        }
    }
    if let Some(length) = length {
        let is_number = !length.is_empty() && length.bytes().all(|b| b.is_ascii_digit());
        head.length = match length.parse() {
            Ok(length) if is_number && length <= LONGEST_BODY => length,
            _ if is_number => return Err(Unread::Refused(413, "the body is too long")),
            _ => return refused("the length of the body is not a number"),
        };
    }
    Ok(Some((head, used)))
}

/// An answer to a request.
pub(super) struct Response {
    pub status: u16,
    pub content_type: &'static str,
    pub body: Cow<'static, [u8]>,
    /// Value of the header `Content-Security-Policy`.
    pub policy: Cow<'static, str>,
}

/// Content security policy of the page. The page loads only its own files and connects only to its own server. Pictures that the
/// page saves come from data in the page.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

impl Response {
    pub(super) fn new(
        status: u16,
        content_type: &'static str,
        body: impl Into<Cow<'static, [u8]>>,
    ) -> Self {
        Response {
            status,
            content_type,
            body: body.into(),
            policy: POLICY.into(),
        }
    }

    /// Response that refuses a request with an HTTP status and a reason as plain text.
    pub(super) fn refusal(status: u16, why: &str) -> Self {
        Response::new(
            status,
            "text/plain; charset=utf-8",
            format!("{why}\n").into_bytes(),
        )
    }

    fn bytes(&self, keeps: bool) -> Vec<u8> {
        let phrase = match self.status {
            200 => "OK",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            409 => "Conflict",
            413 => "Content Too Large",
            415 => "Unsupported Media Type",
            422 => "Unprocessable Content",
            431 => "Request Header Fields Too Large",
            501 => "Not Implemented",
            503 => "Service Unavailable",
            _ => "Internal Server Error",
        };
        let mut bytes = format!(
            "HTTP/1.1 {} {phrase}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: {}\r\n\
             Content-Security-Policy: {}\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
             Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
             Cross-Origin-Opener-Policy: same-origin\r\nX-Frame-Options: DENY\r\n\r\n",
            self.status,
            self.content_type,
            self.body.len(),
            if keeps { "keep-alive" } else { "close" },
            self.policy,
        )
        .into_bytes();
        bytes.extend_from_slice(&self.body);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(request: &str) -> Option<u16> {
        match parsed(request.as_bytes()) {
            Err(Unread::Refused(status, _)) => Some(status),
            _ => None,
        }
    }

    #[test]
    fn heads_are_read_or_refused() {
        let whole = "POST /t/solve?x=1 HTTP/1.1\r\nHost: a:1\r\nContent-Length: 3\r\n\r\nabc";
        let Ok(Some((head, used))) = parsed(whole.as_bytes()) else {
            panic!("it is a request");
        };
        assert_eq!(
            (head.path.as_str(), head.length, head.keeps),
            ("/t/solve", 3, true)
        );
        assert_eq!(&whole[used..], "abc");
        assert!(matches!(parsed(&whole.as_bytes()[..20]), Ok(None)));
        let with = |header: &str| format!("POST / HTTP/1.1\r\n{header}\r\n\r\n");
        for (header, refused) in [
            ("Content-Length: 1048577", 413),
            ("Content-Length: 99999999999999999999999", 413),
            ("Content-Length: +3", 400),
            ("Content-Length: 3\r\nContent-Length: 4", 400),
            ("Host: a\r\nHost: b", 400),
            ("Transfer-Encoding: chunked", 501),
            ("no colon", 400),
        ] {
            assert_eq!(status(&with(header)), Some(refused), "{header}");
        }
        assert_eq!(status("\u{0}\u{1}\r\n\r\n"), Some(400));
    }
}
