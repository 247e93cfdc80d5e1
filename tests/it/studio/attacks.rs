//! Tests of requests from programs or pages that do not know the page's token. Such requests get no data.

use super::client::{answer, request, send};
use super::{Served, sample};
use serde_json::{Value, json};
use std::fs;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::{Duration, Instant};

/// Each request here is complete, but one detail shows that it does not come from the user's page. The server refuses
/// it.
#[test]
fn strangers_are_refused() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let before = served.text();
    let (port, token) = (served.port(), served.token());
    let host = format!("127.0.0.1:{port}");
    let origin = format!("http://{host}");
    let save = served.moved("strut_top", 2, 1.0);
    let body = json!({"of": save, "name": null, "anyway": true}).to_string();
    let own = |name: &str| match name {
        "Host" => host.clone(),
        "Origin" => origin.clone(),
        _ => "application/json".to_owned(),
    };
    let post = |path: &str, changed: &[(&str, Option<&str>)]| {
        let mut headers: Vec<(&str, String)> = Vec::new();
        for name in ["Host", "Origin", "Content-Type"] {
            match changed.iter().find(|(n, _)| *n == name) {
                None => headers.push((name, own(name))),
                Some((_, Some(value))) => headers.push((name, (*value).to_owned())),
                Some((_, None)) => {}
            }
        }
        let headers: Vec<_> = headers.iter().map(|(n, v)| (*n, v.as_str())).collect();
        let answer = send(port, &request("POST", path, &headers, body.as_bytes()));
        answer.expect("a refusal").status
    };
    let path = format!("/{token}/save");
    let guess = format!("/{}/save", "0".repeat(token.len()));
    for wrong in ["/save", "//save", &guess, "/", &format!("/x/{token}/save")] {
        assert_eq!(post(wrong, &[]), 403, "{wrong}");
    }
    for host in [
        None,
        Some("example.com"),
        Some("127.0.0.1"),
        Some("127.0.0.1:1"),
        Some("evil.localhost"),
    ] {
        assert_eq!(post(&path, &[("Host", host)]), 403, "{host:?}");
    }
    for origin in [
        None,
        Some("null"),
        Some("http://example.com"),
        Some("http://localhost"),
        Some("file://"),
    ] {
        assert_eq!(post(&path, &[("Origin", origin)]), 403, "{origin:?}");
    }
    for kind in [
        None,
        Some("text/plain"),
        Some("application/x-www-form-urlencoded"),
    ] {
        assert_eq!(post(&path, &[("Content-Type", kind)]), 415, "{kind:?}");
    }
    for method in ["OPTIONS", "PUT", "DELETE", "HEAD", "TRACE"] {
        let bytes = request(method, &path, &[("Host", &host), ("Origin", &origin)], b"");
        assert_eq!(send(port, &bytes).unwrap().status, 405, "{method}");
    }
    // A page of another origin must not get even a script.
    let foreign = [("Host", host.as_str()), ("Origin", "http://example.com")];
    let bytes = request("GET", &format!("/{token}/main.js"), &foreign, b"");
    assert_eq!(send(port, &bytes).unwrap().status, 403);
    assert_eq!(served.text(), before);
    assert_eq!(served.files(), ["study.toml"]);
    // The server accepts the request if every detail is correct.
    assert_eq!(post(&path, &[]), 200);
    assert_ne!(served.text(), before);
}

#[test]
fn only_the_loopback_interface_is_listened_on() {
    let served = Served::of(&sample("macpherson_front.toml"));
    // Every address of 127/8 is a loopback address. The server must use only 127.0.0.1.
    TcpListener::bind(("127.0.0.2", served.port())).expect("only 127.0.0.1 is taken");
    assert!(TcpListener::bind(("127.0.0.1", served.port())).is_err());
}

#[test]
fn the_page_loads_nothing_and_runs_nothing_else() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let page = served.get("");
    assert_eq!(page.status, 200);
    let policy = page
        .head
        .lines()
        .find(|line| line.starts_with("Content-Security-Policy:"));
    let policy = policy.expect("a policy");
    assert!(policy.contains("default-src 'none'") && policy.contains("connect-src 'self'"));
    assert!(!policy.contains("unsafe") && !policy.contains('*') && !policy.contains("http"));
    for header in [
        "nosniff",
        "no-referrer",
        "X-Frame-Options: DENY",
        "no-store",
    ] {
        assert!(page.head.contains(header), "{header}");
    }
    let text = page.text();
    assert!(!text.contains("<style") && !text.contains(" style=") && !text.contains(" onclick"));
    assert!(!text.contains("http:") && !text.contains("https:"));
    for wrong in [
        "../Cargo.toml",
        "study.toml",
        "%2e%2e/study.toml",
        "report/1",
        "report/../main.js",
        "a",
    ] {
        assert_eq!(served.get(wrong).status, 404, "{wrong}");
    }
}

/// Beginning of a request that asks for solutions.
fn solve_request(served: &Served) -> String {
    let host = format!("127.0.0.1:{}", served.port());
    let path = format!("/{}/solve", served.token());
    format!(
        "POST {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nContent-Type: application/json\r\n"
    )
}

/// A message for which the server gives solutions.
fn good_message(served: &Served) -> Value {
    let overview = served.overview();
    let of = json!({"digest": overview["digest"], "design": overview["design"]});
    json!({"of": of, "characteristics": ["camber"], "at": [0.0, 0.0], "curves_rack": null, "over": 0})
}

#[test]
fn oversized_and_malformed_requests_are_refused() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let port = served.port();
    let head = solve_request(&served);
    let status = |bytes: &[u8]| send(port, bytes).map(|answer| answer.status);
    // The server refuses the request because of its stated length, before it reads a byte of the body.
    for length in ["1048577", "99999999999", "18446744073709551616"] {
        assert_eq!(
            status(format!("{head}Content-Length: {length}\r\n\r\n").as_bytes()),
            Some(413)
        );
    }
    assert_eq!(
        status(format!("{head}Content-Length: -1\r\n\r\n").as_bytes()),
        Some(400)
    );
    assert_eq!(
        status(format!("{head}Transfer-Encoding: chunked\r\n\r\n5\r\n").as_bytes()),
        Some(501)
    );
    assert_eq!(
        status(format!("{head}X: {}\r\n\r\n", "a".repeat(40_000)).as_bytes()),
        Some(431)
    );
    assert_eq!(
        status(format!("{head}{}\r\n", "X: a\r\n".repeat(100)).as_bytes()),
        Some(431)
    );
    assert_eq!(
        status(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n"),
        Some(400)
    );
    assert_eq!(status(b"GET / SPDY/9\r\n\r\n"), Some(400));
    // The client sends half a request, then closes the connection.
    drop(
        TcpStream::connect(("127.0.0.1", port))
            .unwrap()
            .write_all(head.as_bytes()),
    );
    let good = good_message(&served);
    let far = good.to_string().replacen("120.0", "1e999", 1);
    assert!(far.contains("1e999"));
    let bytes = format!("{head}Content-Length: {}\r\n\r\n{far}", far.len());
    assert_eq!(status(bytes.as_bytes()), Some(400));
    let deep = "[".repeat(100_000);
    let bytes = format!("{head}Content-Length: {}\r\n\r\n{deep}", deep.len());
    assert_eq!(status(bytes.as_bytes()), Some(400));
    assert_eq!(served.post("solve", &good).status, 200);
}

#[test]
fn malformed_messages_are_refused() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let good = good_message(&served);
    let of = good["of"].clone();
    let mut messages: Vec<(Value, u16)> = vec![
        (Value::Null, 400),
        (json!([]), 400),
        (json!({"of": of}), 400),
        (json!("solve"), 400),
    ];
    let mut with = |key: &str, value: Value, status: u16| {
        let mut message = good.clone();
        message[key] = value;
        messages.push((message, status));
    };
    with("more", json!(1), 400);
    with("characteristics", json!(["no_such_thing"]), 422);
    with("characteristics", json!("camber"), 400);
    with("at", json!([0.0]), 422);
    with("at", json!([1.0, 2.0, 3.0]), 422);
    with("at", json!([null, 0.0]), 400);
    with("of", json!({"digest": "0", "design": of["design"]}), 410);
    with("of", json!({"digest": of["digest"], "design": []}), 422);
    with(
        "of",
        json!({"digest": of["digest"], "design": [[0.0, 0.0]]}),
        400,
    );
    for (message, status) in messages {
        assert_eq!(served.post("solve", &message).status, status, "{message}");
    }
    assert_eq!(served.post("nothing", &good).status, 404);
    assert_eq!(served.post("solve", &good).status, 200);
}

/// The server refuses coincident points and points at extreme distances with a message, and continues.
#[test]
fn points_of_no_suspension_are_refused() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let good = good_message(&served);
    let mut message = good.clone();
    message["of"]["design"][0] = message["of"]["design"][1].clone();
    message["of"]["design"][2] = json!([1e300, 1e300, -1e300]);
    assert_eq!(served.post("solve", &message).status, 422);
    // The points are impossibly far apart. Without the check the solver would run for minutes.
    let mut message = good.clone();
    message["of"]["design"][2] = json!([0.0, 0.0, 225_000.0]);
    let refused = served.post("solve", &message);
    assert_eq!(refused.status, 422);
    assert!(
        refused.text().contains("impossible for a suspension"),
        "{}",
        refused.text()
    );
    assert_eq!(served.post("solve", &good).status, 200);
    assert_eq!(served.files(), ["study.toml"]);
}

/// The server keeps a connection open for further requests, also if several requests arrive at once.
#[test]
fn connections_are_kept() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let host = format!("127.0.0.1:{}", served.port());
    let one = format!(
        "GET /{}/main.js HTTP/1.1\r\nHost: {host}\r\n\r\n",
        served.token()
    );
    let mut stream = TcpStream::connect(&host).unwrap();
    stream.write_all(one.as_bytes()).unwrap();
    let first = answer(&mut stream).unwrap();
    assert!(first.head.contains("keep-alive"));
    for byte in one.as_bytes() {
        stream.write_all(&[*byte]).unwrap();
    }
    assert_eq!(answer(&mut stream).unwrap().body, first.body);
}

/// Idle connections of other programs do not block the page permanently. The server holds only a limited number of
/// connections.
#[test]
fn a_crowd_of_connections_is_survived() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let host = format!("127.0.0.1:{}", served.port());
    let crowd: Vec<TcpStream> = (0..200)
        .filter_map(|_| TcpStream::connect(&host).ok())
        .collect();
    drop(crowd);
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(30);
    loop {
        let bytes = request(
            "GET",
            &format!("/{}/", served.token()),
            &[("Host", &host)],
            b"",
        );
        match send(served.port(), &bytes) {
            Some(answer) => return assert_eq!(answer.status, 200),
            None => assert!(std::time::Instant::now() < deadline, "no answer"),
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}

/// Other programs that connect and stay silent, or send one letter at a time, do not make the user wait.
#[test]
fn idle_strangers_do_not_lock_the_owner_out() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let host = format!("127.0.0.1:{}", served.port());
    let mut crowd: Vec<TcpStream> = (0..200)
        .map(|_| TcpStream::connect(&host).unwrap())
        .collect();
    for stranger in &mut crowd {
        // The server has already closed the oldest connections.
        let _ = stranger.write_all(b"G");
    }
    let own = format!("GET /{}/ HTTP/1.1\r\nHost: {host}\r\n\r\n", served.token());
    let mut page = TcpStream::connect(&host).unwrap();
    page.set_read_timeout(Some(Duration::from_secs(4))).unwrap();
    page.write_all(own.as_bytes()).unwrap();
    assert_eq!(answer(&mut page).expect("an answer").status, 200);
    // The page has shown its token. So new connections without the token do not close the page's connection.
    crowd.extend((0..100).map(|_| TcpStream::connect(&host).unwrap()));
    page.write_all(own.as_bytes()).unwrap();
    assert_eq!(answer(&mut page).expect("an answer").status, 200);
    assert_eq!(served.get("main.js").status, 200);
    // After a time limit, the server closes all connections that have not shown the token.
    let deadline = Instant::now() + Duration::from_secs(30);
    for stranger in &mut crowd {
        let left = deadline.saturating_duration_since(Instant::now());
        stranger
            .set_read_timeout(Some(left.max(Duration::from_millis(1))))
            .unwrap();
        let ended = match stranger.read(&mut [0; 64]) {
            Ok(count) => count == 0,
            Err(error) => error.kind() == ErrorKind::ConnectionReset,
        };
        assert!(ended, "a connection without the token is still open");
    }
    page.write_all(own.as_bytes()).unwrap();
    assert_eq!(answer(&mut page).expect("an answer").status, 200);
}

/// The page's address is not an argument of the browser, because every user of the machine can read a program's
/// arguments.
#[cfg(target_os = "linux")]
#[test]
fn the_address_is_no_argument_of_the_browser() {
    for is_visited in [true, false] {
        assert_private_invitation(is_visited);
    }
}

#[cfg(target_os = "linux")]
fn assert_private_invitation(is_visited: bool) {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = tempfile::tempdir().unwrap();
    let [opener, said, study] =
        ["xdg-open", "said.txt", "study.toml"].map(|n| folder.path().join(n));
    fs::write(
        &opener,
        format!(
            "#!/bin/sh\necho \"$@\" > {0}.part\nmv {0}.part {0}\n",
            said.display()
        ),
    )
    .unwrap();
    fs::set_permissions(&opener, fs::Permissions::from_mode(0o755)).unwrap();
    fs::write(&study, sample("macpherson_front.toml")).unwrap();
    let path = std::env::var("PATH").unwrap();
    let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_hardpoint"))
        .args([
            "studio",
            "study.toml",
            "--port",
            &super::free_port().to_string(),
        ])
        .current_dir(folder.path())
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let mut address = String::new();
    let out = process.stdout.take().unwrap();
    BufReader::new(out).read_line(&mut address).unwrap();
    let deadline = Instant::now() + Duration::from_secs(30);
    while !said.exists() {
        assert!(Instant::now() < deadline, "no browser was opened");
        std::thread::sleep(Duration::from_millis(20));
    }
    let said = fs::read_to_string(&said).unwrap();
    let token = address.trim().split('/').nth(3).unwrap();
    assert_eq!(token.len(), 32);
    assert!(!said.contains(token) && !said.contains("http"), "{said}");
    let invitation = std::path::PathBuf::from(said.trim());
    assert!(
        fs::read_to_string(&invitation)
            .unwrap()
            .contains(address.trim())
    );
    let own = fs::metadata(&study).unwrap().uid();
    for (place, mode) in [
        (invitation.as_path(), 0o600),
        (invitation.parent().unwrap(), 0o700),
    ] {
        let is = fs::metadata(place).unwrap();
        assert_eq!(
            (is.mode() & 0o777, is.uid()),
            (mode, own),
            "{}",
            place.display()
        );
    }
    // A file contains the address of the page. The server deletes this file after the browser has requested the page,
    // or when the server ends.
    let folder_of_it = invitation.parent().unwrap().to_owned();
    if is_visited {
        let port = address.split([':', '/']).nth(4).unwrap().parse().unwrap();
        let host = format!("127.0.0.1:{port}");
        let page = request("GET", &format!("/{token}/"), &[("Host", &host)], b"");
        assert_eq!(send(port, &page).unwrap().status, 200);
        while folder_of_it.exists() {
            assert!(Instant::now() < deadline, "the file is still there");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    let id = process.id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status();
    assert!(killed.unwrap().success());
    assert_eq!(process.wait().unwrap().code(), Some(130));
    assert!(!folder_of_it.exists());
}

/// If a browser opens an outdated address, the server sends a page that tells the user what to do next. Requests that a
/// page sends to an outdated address get plain text.
#[test]
fn a_stale_address_says_what_to_do() {
    let served = Served::of(&sample("macpherson_front.toml"));
    let host = format!("127.0.0.1:{}", served.port());
    let path = format!("/{}/", "0".repeat(32));
    let opened = send(
        served.port(),
        &request("GET", &path, &[("Host", &host)], b""),
    )
    .unwrap();
    assert_eq!(opened.status, 403);
    assert!(opened.head.contains("text/html") && opened.text().contains("hardpoint studio"));
    assert!(!opened.text().contains(served.token()));
    let origin = format!("http://{host}");
    let asked = request("POST", &path, &[("Host", &host), ("Origin", &origin)], b"");
    let asked = send(served.port(), &asked).unwrap();
    assert!(asked.status == 403 && asked.head.contains("text/plain"));
}

#[test]
fn wrong_calls_say_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_hardpoint"))
            .arg("studio")
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(run(&["none.toml", "--no-open"]).contains("none.toml"));
    assert!(run(&["-", "--no-open"]).contains("standard input"));
    fs::write(
        folder.path().join("wrong.toml"),
        "[suspension]\ntopology = \"macphersn\"\n",
    )
    .unwrap();
    assert!(run(&["wrong.toml", "--no-open"]).contains("wrong.toml"));
    fs::write(
        folder.path().join("good.toml"),
        sample("macpherson_solve.toml"),
    )
    .unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    assert!(run(&["good.toml", "--no-open", "--port", &port]).contains(&port));
    assert!(run(&["good.toml", "--port", "0"]).contains("--port"));
}
