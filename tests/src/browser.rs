//! Pages in a real browser: Chromium without a window, driven by its command line alone.
//!
//! A page is copied with a script at its end, which does what a reader would and leaves its findings in the
//! document; the browser prints the document and the console. No network is reachable from there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

/// Names under which Chromium is installed.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// An installed browser.
#[derive(Debug, Clone)]
pub struct Browser {
    program: PathBuf,
}

/// How a page is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Width of the window.
    pub width: u32,
    /// Height of the window.
    pub height: u32,
    /// Whether the reader prefers dark pages.
    pub is_dark: bool,
}

/// Result of the script and messages of the browser.
#[derive(Debug)]
pub struct Findings {
    /// Return value of the script.
    pub result: Value,
    /// Messages of the console: warnings, errors, refused loads.
    pub console: Vec<String>,
}

impl Browser {
    /// The browser that `GELENK_BROWSER` names, or the first in the path; `None`, with a printed note, where
    /// there is none.
    pub fn find() -> Option<Self> {
        if let Some(program) = std::env::var_os("GELENK_BROWSER") {
            let program = PathBuf::from(program);
            assert!(program.is_file(), "GELENK_BROWSER: no file {}", program.display());
            return Some(Self { program });
        }
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
        let mut places = NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
        let program = places.find(|place| place.is_file());
        if program.is_none() {
            println!("skipped: no Chromium in the path, and GELENK_BROWSER is not set");
        }
        program.map(|program| Self { program })
    }

    /// Opens a page; `script` is the body of a function whose return value, or the promised one, is JSON.
    pub fn visit(&self, page: &str, script: &str, window: Window) -> Findings {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("page.html");
        fs::write(&file, with_script(page, script)).expect("the page");
        let output = self
            .command(folder.path(), window)
            .args(["--virtual-time-budget=30000", "--dump-dom"])
            .arg(format!("file://{}", file.display()))
            .output()
            .expect("the browser starts");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let (dom, log) = (text(&output.stdout), text(&output.stderr));
        let result = between(&dom, "<pre id=\"findings\">", "</pre>");
        let result = result.unwrap_or_else(|| panic!("the page did not come to its end:\n{log}"));
        let result = result.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        let lines = log.lines().filter(|line| line.contains(":CONSOLE"));
        Findings {
            result: serde_json::from_str(&result).unwrap_or_else(|error| panic!("{error}: {result}")),
            console: lines.map(str::to_owned).collect(),
        }
    }

    /// The page on paper; the number of its pages.
    pub fn print(&self, page: &str) -> usize {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, paper) = (folder.path().join("page.html"), folder.path().join("page.pdf"));
        fs::write(&file, page).expect("the page");
        let window = Window { width: 1200, height: 900, is_dark: true };
        self.command(folder.path(), window)
            .arg("--no-pdf-header-footer")
            .arg(format!("--print-to-pdf={}", paper.display()))
            .arg(format!("file://{}", file.display()))
            .output()
            .expect("the browser starts");
        let bytes = fs::read(&paper).expect("the printed page");
        let text = String::from_utf8_lossy(&bytes);
        text.matches("/Type /Page\n").count()
    }

    fn command(&self, folder: &Path, window: Window) -> Command {
        let mut command = Command::new(&self.program);
        command
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--host-resolver-rules=MAP * ~NOTFOUND",
                "--enable-logging=stderr",
                "--log-level=0",
            ])
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .arg(format!("--window-size={},{}", window.width, window.height))
            .stdin(Stdio::null());
        if window.is_dark {
            command.arg("--blink-settings=preferredColorScheme=0");
        }
        command
    }
}

/// Frames come from timers here: the browser's clock is virtual, and jumps over the frames of the real one.
const FRAMES: &str = "<script>window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);</script>";

fn with_script(page: &str, script: &str) -> String {
    let tail = format!(
        "<script>(async () => {{ {script} }})().then(\
         (found) => found, (error) => ({{ failed: String(error) + \" \" + error.stack }})).then((found) => {{\
         const out = document.createElement(\"pre\"); out.id = \"findings\";\
         out.textContent = JSON.stringify(found); document.body.append(out); }});</script>"
    );
    let head = page.find("<title>").expect("a page has a title");
    let end = page.rfind("</body>").expect("a page has a body");
    [&page[..head], FRAMES, &page[head..end], &tail, &page[end..]].concat()
}

fn between<'t>(text: &'t str, start: &str, end: &str) -> Option<&'t str> {
    let from = text.find(start)? + start.len();
    let to = text[from..].find(end)?;
    Some(&text[from..from + to])
}
