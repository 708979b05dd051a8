//! A headless Chromium, driven over WebDriver (<https://www.w3.org/TR/webdriver2/>) through chromedriver.

#![allow(clippy::print_stdout)] // a test that is skipped says so

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A window without a screen.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// Starts one. Without Chromium and chromedriver the test says so and passes, unless `NASTIC_REQUIRE_BROWSER=1`.
    pub fn start() -> Option<Self> {
        let driver = Command::new("chromedriver").arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let Ok(mut driver) = driver else {
            let required = std::env::var("NASTIC_REQUIRE_BROWSER").is_ok_and(|value| value == "1");
            assert!(!required, "NASTIC_REQUIRE_BROWSER is 1, and there is no chromedriver");
            println!("SKIPPED: no chromedriver; on Debian: apt-get install chromium chromium-driver");
            return None;
        };
        let mut lines = BufReader::new(driver.stdout.take().unwrap()).lines().map_while(Result::ok);
        let line = lines.find(|line| line.contains("started successfully on port")).unwrap();
        let digits: String = line.chars().filter(char::is_ascii_digit).collect();
        let profile = tempfile::tempdir().unwrap();
        let mut browser = Self { driver, port: digits.parse().unwrap(), session: String::new(), _profile: profile };
        std::thread::spawn(move || lines.for_each(drop));
        let mut arguments: Vec<String> = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--window-size=1100,900",
            "--disable-dev-shm-usage",
        ]
        .map(str::to_owned)
        .to_vec();
        arguments.push(format!("--user-data-dir={}", browser._profile.path().display()));
        let asked = json!({ "capabilities": { "alwaysMatch": {
            "goog:chromeOptions": { "args": arguments }, "goog:loggingPrefs": { "browser": "ALL" },
        } } });
        let answer = browser.call("POST", "/session", &asked);
        browser.session = answer["sessionId"].as_str().unwrap_or_else(|| panic!("{answer}")).to_owned();
        Some(browser)
    }

    /// Opens a file and waits until its program has run.
    pub fn open(&self, file: &Path) {
        let file = file.canonicalize().unwrap();
        self.command("url", &json!({ "url": format!("file://{}", file.display()) }));
        let began = Instant::now();
        while self.run("return document.documentElement.dataset.ready") != "true" {
            assert!(began.elapsed() < Duration::from_secs(30), "{}: {:?}", file.display(), self.complaints());
            std::thread::sleep(Duration::from_millis(20));
        }
        self.settle();
    }

    /// Waits until what has changed is drawn.
    pub fn settle(&self) {
        let script = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()))";
        self.command("execute/async", &json!({ "script": script, "args": [] }));
    }

    /// The value of a script.
    pub fn run(&self, script: &str) -> Value {
        self.command("execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// Presses a key (WebDriver's code) at the element that has the focus.
    pub fn press(&self, key: char) {
        let actions = json!([{ "type": "key", "id": "keys", "actions": [
            { "type": "keyDown", "value": key }, { "type": "keyUp", "value": key },
        ] }]);
        self.command("actions", &json!({ "actions": actions }));
        self.settle();
    }

    /// Drags with the left button from one point of the window to another.
    pub fn drag(&self, from: [i64; 2], to: [i64; 2]) {
        let step = |at: [i64; 2]| json!({ "type": "pointerMove", "duration": 30, "x": at[0], "y": at[1] });
        let actions = json!([{ "type": "pointer", "id": "mouse", "parameters": { "pointerType": "mouse" }, "actions": [
            step(from), { "type": "pointerDown", "button": 0 }, step(to), { "type": "pointerUp", "button": 0 },
        ] }]);
        self.command("actions", &json!({ "actions": actions }));
        self.settle();
    }

    /// Width and height of the window.
    pub fn resize(&self, width: u32, height: u32) {
        self.command("window/rect", &json!({ "width": width, "height": height }));
        self.settle();
    }

    /// Errors of the console since this was asked last.
    pub fn complaints(&self) -> Vec<String> {
        let log = self.command("se/log", &json!({ "type": "browser" }));
        let severe = log.as_array().into_iter().flatten().filter(|entry| entry["level"] == "SEVERE");
        severe.map(|entry| entry["message"].to_string()).collect()
    }

    fn command(&self, name: &str, body: &Value) -> Value {
        self.call("POST", &format!("/session/{}/{name}", self.session), body)
    }

    /// One request of HTTP/1.1; the connection is closed after it.
    fn call(&self, method: &str, path: &str, body: &Value) -> Value {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let body = body.to_string();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\
             Connection: close\r\n\r\n",
            self.port,
            body.len()
        );
        stream.write_all(format!("{head}{body}").as_bytes()).unwrap();
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(reader.read_line(&mut line).unwrap() > 0, "{method} {path}: no answer");
            if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
            if line == "\r\n" {
                break;
            }
        }
        let mut answer = vec![0; length];
        reader.read_exact(&mut answer).unwrap();
        let answer: Value = serde_json::from_slice(&answer).unwrap();
        assert!(answer["value"]["error"].is_null(), "{method} {path}: {}", answer["value"]["message"]);
        answer["value"].clone()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() && !std::thread::panicking() {
            self.call("DELETE", &format!("/session/{}", self.session), &json!({}));
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
