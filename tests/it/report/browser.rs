//! Tests of the page in a real browser, if one is installed.

use super::*;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

const BROWSERS: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];
const PATIENCE: Duration = Duration::from_secs(300);

fn browser() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    let mut all = BROWSERS
        .iter()
        .flat_map(|name| folders.iter().map(move |f| f.join(name)));
    all.find(|path| path.is_file())
}

/// State of a page in a browser: attributes of its root element, and its console messages.
struct Shown {
    root: String,
    console: Vec<String>,
}

impl Shown {
    fn of(browser: &Path, run: &Run, hash: &str) -> Shown {
        let (dom, log) = Shown::dom(browser, run, hash);
        let start = dom
            .find("<html")
            .unwrap_or_else(|| panic!("no page:\n{log}"));
        let end = start + dom[start..].find('>').unwrap();
        let said = log.lines().filter(|l| l.contains(":CONSOLE"));
        Shown {
            root: dom[start..end].to_owned(),
            console: said.map(str::to_owned).collect(),
        }
    }

    /// The document after its scripts have run, and the browser's log.
    fn dom(browser: &Path, run: &Run, hash: &str) -> (String, String) {
        let scratch = tempfile::tempdir().unwrap();
        let [dom, log] = ["dom", "log"].map(|name| scratch.path().join(name));
        let child = std::process::Command::new(browser)
            .args([
                "--headless",
                "--no-sandbox",
                "--no-first-run",
                "--disable-extensions",
            ])
            .args(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            .args([
                "--enable-logging=stderr",
                "--virtual-time-budget=20000",
                "--dump-dom",
            ])
            .arg(format!(
                "--user-data-dir={}",
                scratch.path().join("profile").display()
            ))
            .arg(format!(
                "file://{}{hash}",
                run.path().join("report.html").display()
            ))
            .stdout(fs::File::create(&dom).unwrap())
            .stderr(fs::File::create(&log).unwrap())
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        wait(child);
        let dom = String::from_utf8_lossy(&fs::read(&dom).unwrap()).into_owned();
        let log = String::from_utf8_lossy(&fs::read(&log).unwrap()).into_owned();
        (dom, log)
    }

    fn attribute(&self, name: &str) -> &str {
        let opening = format!("data-{name}=\"");
        let start = self
            .root
            .find(&opening)
            .unwrap_or_else(|| panic!("{name}: {}", self.root));
        let value = &self.root[start + opening.len()..];
        &value[..value.find('"').unwrap()]
    }
}

#[test]
fn a_browser_draws_a_sweep_and_shows_a_design() {
    let Some(browser) = browser() else {
        skipped();
        return;
    };
    let far = [
        "--set",
        "sweep.samples=400",
        "--set",
        "motion.travel=[-360.0, 0.0, 300.0]",
    ];
    let run = sweep(HOSTILE_NAME, &far);
    let (header, columns) = run.csv("designs.csv");
    let status = columns.last().unwrap();
    let whole = status.iter().position(|s| s == "ok").unwrap();
    let failed = status.iter().position(|s| s != "ok").unwrap();
    for design in [whole, failed] {
        let shown = Shown::of(&browser, &run, &format!("#design={design}&theme=dark"));
        assert!(shown.console.is_empty(), "{:#?}", shown.console);
        assert_eq!(shown.attribute("errors"), "0", "{}", shown.root);
        assert_eq!(shown.attribute("ready"), "true");
        // Plots: the scatter, the parallel coordinates and two plots of effects. In addition, curves and mechanism of
        // designs that have them.
        let plots = shown.attribute("plots-drawn");
        assert_eq!(shown.attribute("plots-expected"), plots);
        assert!(plots.parse::<usize>().unwrap() >= 4);
        assert_eq!(shown.attribute("picked"), design.to_string());
        let values: Vec<&str> = shown.attribute("picked-values").split(' ').collect();
        let cells = &columns[1..header.len() - 4];
        assert_eq!(values.len(), cells.len());
        for (value, column) in values.iter().zip(cells) {
            let cell = &column[design];
            assert_eq!(value.parse::<f64>().ok(), cell.parse().ok(), "{cell}");
        }
    }
}

/// Below a chart, the page draws the deviations from the target. It draws them only for the shown designs.
#[test]
fn the_strip_of_a_chart_is_of_the_shown_design() {
    let Some(browser) = browser() else {
        skipped();
        return;
    };
    let run = sweep("plain", &["--set", "sweep.samples=60"]);
    let data = run.data();
    let drawn = data["drawn"].as_array().unwrap();
    assert!(drawn.len() > 3);
    for place in [1, drawn.len() - 1] {
        let dom = Shown::dom(&browser, &run, &format!("#design={}", drawn[place])).0;
        let strips: Vec<&str> = dom.split("<g class=\"strip\">").skip(1).collect();
        assert!(!strips.is_empty());
        let mut seen = 0;
        for strip in strips {
            let strip = &strip[..strip.find("</g>").unwrap()];
            for (k, _) in drawn.iter().enumerate() {
                let own = format!("of-{k}\"");
                let paths = strip.split("<path").filter(|path| path.contains(&own));
                for path in paths {
                    let is_shown = !path.contains("display: none");
                    assert_eq!(is_shown, k == 0 || k == place, "design {k}: {path}");
                    seen += usize::from(is_shown);
                }
            }
        }
        assert!(seen >= 2);
    }
}

fn skipped() {
    eprintln!(
        "\n*** SKIPPED: no browser ({}) to open the report in ***\n",
        BROWSERS.join(", ")
    );
}

fn wait(mut child: Child) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("the browser did not end within {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(100));
    }
}

#[test]
fn a_browser_draws_everything_and_moves_the_wheel() {
    let Some(browser) = browser() else {
        skipped();
        return;
    };
    let run = hostile();
    let (header, columns) = run.csv("curves.csv");
    let outputs = header.len() - 2;
    for station in [5, 30] {
        let shown = Shown::of(&browser, &run, &format!("#station={station}"));
        assert!(shown.console.is_empty(), "{:#?}", shown.console);
        assert_eq!(shown.attribute("errors"), "0", "{}", shown.root);
        assert_eq!(shown.attribute("ready"), "true");
        // Plots: the curves, the mechanism, the history, two plots of sensitivities, and misfit against the size of the
        // design change.
        assert_eq!(shown.attribute("plots-drawn"), (outputs + 5).to_string());
        assert_eq!(shown.attribute("station"), station.to_string());
        let centre: Vec<f64> = shown
            .attribute("wheel-centre")
            .split(' ')
            .map(|n| n.parse().unwrap())
            .collect();
        let solved: Vec<f64> = ["x", "y", "z"]
            .iter()
            .map(|axis| {
                let name = format!("wheel_centre_{axis}_mm");
                let column = header.iter().position(|n| *n == name).unwrap();
                columns[column][station].parse().unwrap()
            })
            .collect();
        assert_eq!(centre, solved);
    }
}

/// A browser draws both wheels, the path of the roll centre, and the turn seen from above. It draws them at the
/// positions of both sliders.
#[test]
fn a_browser_draws_an_axle() {
    let Some(browser) = browser() else {
        skipped();
        return;
    };
    let path = studies().join("macpherson_axle.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let run = super::Run::of("solve", "axle", &text, &[]);
    let shown = Shown::of(&browser, &run, "#station=12&rack=1");
    assert!(shown.console.is_empty(), "{:#?}", shown.console);
    assert_eq!(shown.attribute("errors"), "0", "{}", shown.root);
    assert_eq!(shown.attribute("ready"), "true");
    let data = run.data();
    let outputs = data["record"]["outputs"].as_array().unwrap();
    // Both wheels share a chart. Each coordinate of the motion also has a chart. The mechanism and the turn are two
    // more plots.
    let column = |output: &serde_json::Value| output["column"].as_str().unwrap().to_owned();
    let right = |output: &&serde_json::Value| column(output).starts_with("right_");
    let along = 1 + data["record"]["further"].as_array().unwrap().len();
    let plots = along * (outputs.len() - outputs.iter().filter(right).count()) + 2;
    assert_eq!(shown.attribute("plots-drawn"), plots.to_string());
    assert_eq!(shown.attribute("plots-expected"), plots.to_string());
    assert_eq!(shown.attribute("station"), "12");
}

/// On a phone, each row of a wide table becomes a block within the window. In a window of usual width, the table of
/// effects is as wide as its content, because there is space.
#[test]
fn tables_use_the_width_of_the_window() {
    let Some(browser) = crate::studio::webdriver::Browser::start() else {
        skipped();
        return;
    };
    let run = sweep("plain", &["--set", "sweep.samples=60"]);
    browser.size(390, 844);
    browser.open(&format!(
        "file://{}",
        run.path().join("report.html").display()
    ));
    browser.wait("document.documentElement.dataset.ready");
    let outside = browser.run(
        "const all = [...document.querySelectorAll('.stacked td')].filter((e) => e.checkVisibility()); \
         return all.length > 20 ? all.filter((e) => { const { left, right } = e.getBoundingClientRect(); return left < 0 || right > innerWidth || e.scrollWidth > e.clientWidth + 1; }).map((e) => e.textContent) : 'few'",
    );
    assert_eq!(outside, serde_json::json!([]));
    browser.size(1440, 900);
    let cut = browser.run(
        "const e = document.getElementById('effects-map'); return e.scrollWidth - e.clientWidth",
    );
    assert!(cut.as_f64().unwrap() <= 1.0, "{cut}");
}
