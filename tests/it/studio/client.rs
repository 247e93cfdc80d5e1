//! Minimal HTTP client. It sends well-formed and malformed requests.

use super::Served;
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Response of the server: status, head and body.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", self.text());
        serde_json::from_slice(&self.body).unwrap()
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }
}

/// Sends bytes to a port and reads the answer. `None` if the server closes the connection without an answer.
pub fn send(port: u16, bytes: &[u8]) -> Option<Answer> {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_secs(60)))
        .unwrap();
    // The server may refuse and close the connection before it has read everything.
    let _ = stream.write_all(bytes);
    answer(&mut stream)
}

/// Reads one answer.
pub fn answer(stream: &mut TcpStream) -> Option<Answer> {
    let mut bytes = Vec::new();
    let mut piece = [0; 65536];
    let end = loop {
        if let Some(end) = bytes.windows(4).position(|w| w == b"\r\n\r\n") {
            break end;
        }
        match stream.read(&mut piece) {
            Ok(0) | Err(_) => return None,
            Ok(count) => bytes.extend_from_slice(&piece[..count]),
        }
    };
    let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
    let length = head.lines().find_map(|line| {
        let (name, value) = line.split_once(':')?;
        name.eq_ignore_ascii_case("content-length")
            .then(|| value.trim().parse().unwrap())
    });
    let length: usize = length.unwrap_or(0);
    let mut body = bytes.split_off(end + 4);
    while body.len() < length {
        match stream.read(&mut piece) {
            Ok(0) | Err(_) => return None,
            Ok(count) => body.extend_from_slice(&piece[..count]),
        }
    }
    body.truncate(length);
    let status = head.split(' ').nth(1).unwrap().parse().unwrap();
    Some(Answer { status, head, body })
}

/// Bytes of a request with these headers. The function also writes the length of the body.
pub fn request(method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Vec<u8> {
    let mut head = format!(
        "{method} {path} HTTP/1.1\r\nContent-Length: {}\r\n",
        body.len()
    );
    for (name, value) in headers {
        head += &format!("{name}: {value}\r\n");
    }
    [head.as_bytes(), b"Connection: close\r\n\r\n", body].concat()
}

impl Served {
    /// Sends a message as the page would send it.
    pub fn post(&self, what: &str, message: &Value) -> Answer {
        let host = format!("127.0.0.1:{}", self.port());
        let origin = format!("http://{host}");
        let headers = [
            ("Host", host.as_str()),
            ("Origin", &origin),
            ("Content-Type", "application/json"),
        ];
        let path = format!("/{}/{what}", self.token());
        let bytes = request("POST", &path, &headers, message.to_string().as_bytes());
        let mut answer = send(self.port(), &bytes).expect("an answer");
        // Some refusals are not errors of the request. In this case, the body contains the status.
        if let Ok(body) = serde_json::from_slice::<Value>(&answer.body)
            && let Some(refused) = body["refused"].as_u64()
        {
            answer.status = u16::try_from(refused).unwrap();
        }
        answer
    }

    pub fn get(&self, path: &str) -> Answer {
        let host = format!("127.0.0.1:{}", self.port());
        let path = format!("/{}/{path}", self.token());
        send(self.port(), &request("GET", &path, &[("Host", &host)], b"")).expect("an answer")
    }

    pub fn overview(&self) -> Value {
        self.post("study", &Value::Null).json()
    }

    /// Design of the study with one coordinate moved.
    pub fn moved(&self, point: &str, axis: usize, by: f64) -> Value {
        let overview = self.overview();
        let points = overview["points"].as_array().unwrap();
        let place = points.iter().position(|p| p["name"] == point).unwrap();
        let mut design = overview["design"].clone();
        let old = design[place][axis].as_f64().unwrap();
        design[place][axis] = json!(old + by);
        json!({"digest": overview["digest"], "design": design})
    }
}
