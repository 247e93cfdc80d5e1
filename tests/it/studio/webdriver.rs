//! Part of WebDriver (W3C Recommendation, 2018) that the tests need to use a page in Chromium.

use super::client::{answer, request};
use serde_json::{Value, json};
use std::io::Write;
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// Browser controlled by a program.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    _profile: tempfile::TempDir,
}

fn found(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders)
        .map(|f| f.join(name))
        .find(|path| path.is_file())
}

impl Browser {
    /// Starts a browser without a window, if one is installed.
    pub fn start() -> Option<Browser> {
        let (Some(program), Some(driver)) = (
            ["chromium", "chromium-browser", "google-chrome"]
                .iter()
                .find_map(|name| found(name)),
            found("chromedriver"),
        ) else {
            eprintln!("\n*** SKIPPED: no chromium with chromedriver to use the live page in ***\n");
            return None;
        };
        let port = super::free_port();
        let profile = tempfile::tempdir().unwrap();
        let driver = Command::new(driver)
            .arg(format!("--port={port}"))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut browser = Browser {
            driver,
            port,
            session: String::new(),
            _profile: profile,
        };
        let start = Instant::now();
        while TcpStream::connect(("127.0.0.1", port)).is_err() {
            assert!(start.elapsed() < PATIENCE, "chromedriver does not listen");
            std::thread::sleep(Duration::from_millis(50));
        }
        let profile = browser._profile.path().display().to_string();
        let arguments = [
            "--headless=new",
            "--no-sandbox",
            "--no-first-run",
            "--disable-gpu",
            "--window-size=1440,900",
        ];
        let mut arguments: Vec<String> = arguments.map(str::to_owned).to_vec();
        arguments.push(format!("--user-data-dir={profile}"));
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "goog:chromeOptions": {"args": arguments, "binary": program},
            "goog:loggingPrefs": {"browser": "ALL"},
        }}});
        let made = browser.call("POST", "/session", &wanted);
        browser.session = made["sessionId"].as_str().expect("a session").to_owned();
        Some(browser)
    }

    fn call(&self, method: &str, path: &str, message: &Value) -> Value {
        let host = format!("127.0.0.1:{}", self.port);
        let mut stream = TcpStream::connect(&host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let body = match method {
            "POST" => message.to_string(),
            _ => String::new(),
        };
        let headers = [
            ("Host", host.as_str()),
            ("Content-Type", "application/json"),
        ];
        stream
            .write_all(&request(method, path, &headers, body.as_bytes()))
            .unwrap();
        let answer = answer(&mut stream).expect("an answer of chromedriver");
        let value: Value = serde_json::from_slice(&answer.body).unwrap();
        assert_eq!(answer.status, 200, "{path}: {value}");
        value["value"].clone()
    }

    fn command(&self, command: &str, message: &Value) -> Value {
        self.call(
            "POST",
            &format!("/session/{}/{command}", self.session),
            message,
        )
    }

    pub fn open(&self, address: &str) {
        self.command("url", &json!({"url": address}));
    }

    /// Opens an address in a new tab and switches to it.
    pub fn open_tab(&self, address: &str) -> String {
        let made = self.command("window/new", &json!({"type": "tab"}));
        let handle = made["handle"].as_str().unwrap().to_owned();
        self.go_to(&handle);
        self.open(address);
        handle
    }

    pub fn tab(&self) -> String {
        let path = format!("/session/{}/window", self.session);
        self.call("GET", &path, &Value::Null)
            .as_str()
            .unwrap()
            .to_owned()
    }

    pub fn go_to(&self, tab: &str) {
        self.command("window", &json!({"handle": tab}));
    }

    /// Shows pages in the layout for print.
    pub fn print(&self) {
        self.emulate("setEmulatedMedia", &json!({"media": "print"}));
    }

    /// Shows pages in a window of this size.
    pub fn size(&self, width: u32, height: u32) {
        let size =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.emulate("setDeviceMetricsOverride", &size);
    }

    fn emulate(&self, what: &str, parameters: &Value) {
        let message = json!({"cmd": format!("Emulation.{what}"), "params": parameters});
        self.command("goog/cdp/execute", &message);
    }

    /// Return value of a script.
    pub fn run(&self, script: &str) -> Value {
        self.command("execute/sync", &json!({"script": script, "args": []}))
    }

    /// Waits until a script returns a true value.
    pub fn wait(&self, condition: &str) {
        let start = Instant::now();
        while self.run(&format!("return Boolean({condition})")) != true {
            if start.elapsed() > PATIENCE {
                let banner = self.run("return document.getElementById('banner')?.textContent");
                panic!(
                    "waited for {condition}; the page says {banner}; {:?}",
                    self.console()
                );
            }
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    pub fn click(&self, selector: &str) {
        let found = self.run(&format!(
            "const e = document.querySelector({selector:?}); e?.click(); return Boolean(e)"
        ));
        assert_eq!(found, true, "there is no {selector}");
    }

    /// Drags an element with the mouse, by pixels, in some steps.
    pub fn drag(&self, selector: &str, by: [i64; 2], steps: i64) {
        self.drag_by("mouse", selector, by, steps);
        self.let_go("mouse");
    }

    /// Drags an element with the mouse, and holds it. [`Self::release`] ends the drag.
    pub fn press(&self, selector: &str, by: [i64; 2]) {
        self.drag_by("mouse", selector, by, 4);
    }

    /// Releases the mouse.
    pub fn release(&self) {
        self.let_go("mouse");
    }

    /// Drags an element with one finger, by pixels, in some steps.
    pub fn touch(&self, selector: &str, by: [i64; 2], steps: i64) {
        self.drag_by("touch", selector, by, steps);
        self.let_go("touch");
    }

    fn let_go(&self, kind: &str) {
        self.point(kind, json!([{"type": "pointerUp", "button": 0}]));
    }

    fn point(&self, kind: &str, actions: Value) {
        let pointer = json!({"type": "pointer", "id": kind, "parameters": {"pointerType": kind}, "actions": actions});
        self.command("actions", &json!({"actions": [pointer]}));
    }

    fn drag_by(&self, kind: &str, selector: &str, by: [i64; 2], steps: i64) {
        let middle = self.run(&format!(
            "const e = document.querySelector({selector:?}); e.scrollIntoView({{ block: 'center' }}); \
             const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]"
        ));
        let [x, y] = [0, 1].map(|k| middle[k].as_f64().unwrap().round() as i64);
        let mut actions = vec![
            json!({"type": "pointerMove", "duration": 0, "x": x, "y": y}),
            json!({"type": "pointerDown", "button": 0}),
        ];
        for step in 1..=steps {
            let (x, y) = (x + by[0] * step / steps, y + by[1] * step / steps);
            actions.push(json!({"type": "pointerMove", "duration": 20, "x": x, "y": y}));
        }
        self.point(kind, Value::from(actions));
    }

    /// Presses keys one after another. Special keys are given by their WebDriver code points.
    pub fn keys(&self, keys: &[&str]) {
        let mut actions = Vec::new();
        for key in keys {
            actions.push(json!({"type": "keyDown", "value": key}));
            actions.push(json!({"type": "keyUp", "value": key}));
        }
        let keyboard = json!({"type": "key", "id": "keyboard", "actions": actions});
        self.command("actions", &json!({"actions": [keyboard]}));
    }

    /// Console warnings and errors since the last call.
    pub fn console(&self) -> Vec<String> {
        let entries = self.command("se/log", &json!({"type": "browser"}));
        let entries = entries.as_array().unwrap().iter();
        entries
            .map(|entry| entry["message"].as_str().unwrap_or_default().to_owned())
            .collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() && !std::thread::panicking() {
            self.call(
                "DELETE",
                &format!("/session/{}", self.session),
                &Value::Null,
            );
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
