//! Access control of the server.
//!
//! Every page in every browser on this machine, and every program, can reach a loopback port. Three checks protect the server.
//! The token keeps out programs and pages that do not know the address. `Host` keeps out foreign host names that resolve to this
//! machine (DNS rebinding). `Origin` keeps out pages that guess the address.

use std::net::SocketAddr;

/// Token and host names that a request to the server must have.
pub(super) struct Access {
    token: String,
    hosts: [String; 2],
}

impl Access {
    /// Makes the access control of a server at an address, with a new random token from the operating system.
    pub(super) fn new(address: SocketAddr) -> std::io::Result<Self> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
        let port = address.port();
        Ok(Access {
            token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
            hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}")),
        })
    }

    /// Address of the page with the token, as a browser needs it.
    pub(super) fn address(&self) -> String {
        format!("http://{}/{}/", self.hosts[0], self.token)
    }

    /// Rest of the path of a request after the token. `None` if the token is missing or wrong.
    pub(super) fn rest<'p>(&self, path: &'p str) -> Option<&'p str> {
        let (token, rest) = path.strip_prefix('/')?.split_once('/')?;
        is_same(token.as_bytes(), self.token.as_bytes()).then_some(rest)
    }

    /// True if the header `Host` of a request names this server.
    pub(super) fn is_host(&self, host: &str) -> bool {
        self.hosts.iter().any(|own| own.eq_ignore_ascii_case(host))
    }

    /// True if the header `Origin` of a request names a page of this server.
    pub(super) fn is_origin(&self, origin: &str) -> bool {
        let host = origin.strip_prefix("http://");
        host.is_some_and(|host| self.is_host(host))
    }
}

/// Compares a given token with the own token, in a time that does not reveal where they differ.
fn is_same(given: &[u8], own: &[u8]) -> bool {
    let differences = given.iter().zip(own).fold(0, |sum, (a, b)| sum | (a ^ b));
    given.len() == own.len() && differences == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_printed_address_passes() {
        let access = Access::new("127.0.0.1:4711".parse().unwrap()).unwrap();
        let path = access.address();
        let path = path.strip_prefix("http://127.0.0.1:4711").unwrap();
        assert_eq!(access.rest(path), Some(""));
        assert_eq!(access.rest(&format!("{path}a/b")), Some("a/b"));
        let token = path.trim_matches('/');
        let mut wrong = token.to_owned();
        let last = if wrong.pop() == Some('0') { '1' } else { '0' };
        wrong.push(last);
        for path in [
            "",
            "/",
            "//",
            "/x/",
            &format!("/{wrong}/"),
            &format!("/{token}"),
        ] {
            assert_eq!(access.rest(path), None, "{path}");
        }
        assert!(access.is_host("localhost:4711") && access.is_origin("http://127.0.0.1:4711"));
        for host in [
            "127.0.0.1",
            "127.0.0.1:4712",
            "example.com:4711",
            "localhost.example.com:4711",
        ] {
            assert!(!access.is_host(host), "{host}");
        }
        for origin in [
            "null",
            "https://127.0.0.1:4711",
            "http://127.0.0.1:4711/",
            "http://example.com",
        ] {
            assert!(!access.is_origin(origin), "{origin}");
        }
    }

    #[test]
    fn tokens_differ() {
        let address = "127.0.0.1:4711".parse().unwrap();
        let [a, b] = [(); 2].map(|()| Access::new(address).unwrap().address());
        assert_ne!(a, b);
    }
}
