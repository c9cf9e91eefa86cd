//! Pages as a browser sees them: Debian's `chromium`, without a window.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Names under which systems have it.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// What a page says of itself when it is opened, looked at and used; see `look.html`.
///
/// The page stands in a frame of this width [px], because a window is not made narrower than 500.
pub fn look(html: &str, width: u32) -> Value {
    found(include_str!("look.html"), html, width)
}

/// What is seen of the run in a page while its slider is put to a time [s], its traces are zoomed and
/// pointed at, and it is played; see `run.html`.
#[allow(dead_code)] // Not every test of pages has a run.
pub fn play(html: &str, width: u32, time: f64) -> Value {
    let harness = include_str!("run.html").replace("SLIDE", &time.to_string());
    found(&harness, html, width)
}

/// What the figures in a page say where they are pointed at, and how they are zoomed; lines are read at `places`,
/// parts of the width of their frame; see `figure.html`.
#[allow(dead_code)] // Not every test of pages reads figures.
pub fn point_at(html: &str, width: u32, places: &[f64]) -> Value {
    let places = serde_json::to_string(places).unwrap();
    let harness = include_str!("figure.html").replace("PLACES", &places);
    found(&harness, html, width)
}

/// What a harness leaves of the page in its frame.
fn found(harness: &str, html: &str, width: u32) -> Value {
    let folder = TempDir::new().unwrap();
    let quoted = serde_json::to_string(html).unwrap().replace("</", "<\\/");
    let harness = harness
        .replace("WIDTH", &width.to_string())
        .replace("PAGE", &quoted);
    let file = folder.path().join("look.html");
    fs::write(&file, harness).unwrap();
    let output = browser(
        folder.path(),
        &["--dump-dom", "--virtual-time-budget=20000"],
        &file,
    );
    let errors = String::from_utf8_lossy(&output.stderr);
    let said: Vec<&str> = errors.lines().filter(|l| l.contains("CONSOLE")).collect();
    assert!(said.is_empty(), "the console: {said:#?}");
    let dom = String::from_utf8(output.stdout).unwrap();
    let found = dom
        .split_once("<pre id=\"found\">")
        .and_then(|(_, rest)| rest.split_once("</pre>"))
        .unwrap_or_else(|| panic!("the page was not looked at: {errors}"));
    let json = found.0.replace("&lt;", "<").replace("&gt;", ">");
    serde_json::from_str(&json.replace("&amp;", "&")).unwrap()
}

/// Number of sheets of A4 on which the page prints.
#[allow(dead_code)] // Not every test of pages prints.
pub fn sheets(html: &str) -> usize {
    let folder = TempDir::new().unwrap();
    let [file, pdf] = ["page.html", "page.pdf"].map(|name| folder.path().join(name));
    fs::write(&file, html).unwrap();
    let into = format!("--print-to-pdf={}", pdf.display());
    let output = browser(folder.path(), &["--no-pdf-header-footer", &into], &file);
    let printed = fs::read(&pdf).unwrap_or_else(|error| {
        let errors = String::from_utf8_lossy(&output.stderr);
        panic!("nothing was printed: {error}\n{errors}")
    });
    let text = String::from_utf8_lossy(&printed);
    text.matches("/Type /Page\n").count()
}

fn browser(home: &Path, arguments: &[&str], page: &Path) -> Output {
    let profile = home.join("profile");
    let mut command = Command::new(program());
    command
        .env("HOME", home)
        .args(["--headless", "--no-sandbox", "--disable-gpu"])
        .args(["--enable-logging=stderr", "--hide-scrollbars"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(arguments)
        .arg(format!("file://{}", page.display()));
    let output = command.output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

fn program() -> PathBuf {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    let mut places = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    places.find(|place| place.is_file()).expect(
        "pages are tested in Chromium, which is not here: install it (apt-get install chromium)",
    )
}
