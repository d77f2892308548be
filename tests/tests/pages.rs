//! Pages of reports in a real browser: nothing is loaded, nothing fails, everything is there and answers.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use gelenk_codegen::functions::selection;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::model::{Model, QuaternionJoint};
use gelenk_codegen::read::{ReadOptions, read};
use gelenk_codegen::report::{Contents, report};
use gelenk_report::{
    Axis, Block, Claim, Criterion, Equation, Figure, Marks, Pattern, Plot, Report, Section, Table, text,
};
use gelenk_tests::browser::{Browser, Findings, Window};
use gelenk_tests::workspace;
use nalgebra::{UnitQuaternion, Vector3};
use serde_json::{Value, json};

const WIDE: Window = Window { width: 1400, height: 900, is_dark: false };
const NARROW: Window = Window { width: 500, height: 900, is_dark: true };

/// Checks of every page.
const COMMON: &str = r##"
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const all = (selector) => [...document.querySelectorAll(selector)];
    const ids = all("[id]").map((element) => element.id);
    const empty = all("main svg, main canvas, main math, main table, figure").filter((element) => {
        if (element.closest("details:not([open])")) return false;
        const box = element.getBoundingClientRect();
        return box.width < 1 || box.height < 1;
    });
    const findings = {
        title: document.title,
        loaded: performance.getEntriesByType("resource").map((entry) => entry.name),
        repeatedIds: ids.filter((id, k) => ids.indexOf(id) !== k),
        deadLinks: all("a[href^='#']").map((a) => a.getAttribute("href").slice(1))
            .filter((id) => !document.getElementById(id)),
        mathErrors: all("merror").length,
        empty: empty.map((element) => element.outerHTML.slice(0, 120)),
        nameless: all("[role=img], input, button").filter((element) =>
            !(element.getAttribute("aria-label") || element.labels?.[0]?.textContent || element.textContent).trim())
            .map((element) => element.outerHTML.slice(0, 120)),
        overflow: document.documentElement.scrollWidth - innerWidth,
        background: getComputedStyle(document.documentElement).backgroundColor,
        math: all("math").length,
        plots: all("svg.plot").length,
        curves: all("svg.plot").every((svg) => {
            const line = svg.querySelector("[stroke^='var(--series'], [fill^='var(--series']");
            const style = line && getComputedStyle(line);
            return style && [style.stroke, style.fill].some((paint) => paint.startsWith("rgb"));
        }),
        verdicts: all(".verdict").map((verdict) => verdict.textContent.trim()),
    };
"##;

/// Moves a robot as a reader with a keyboard would.
const ROBOT: &str = r##"
    const canvas = document.querySelector(".scene canvas"), context = canvas.getContext("2d");
    const settled = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const picture = () => canvas.toDataURL();
    const colours = () => {
        const data = new Uint32Array(context.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
        return new Set(data).size;
    };
    const key = async (name) => {
        canvas.focus();
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true, cancelable: true }));
        await settled();
        return picture();
    };
    findings.focusable = canvas.tabIndex === 0 && (canvas.focus(), document.activeElement === canvas);
    const start = picture();
    findings.colours = colours();
    findings.turned = (await key("ArrowRight")) !== start;
    findings.zoomed = (await key("+")) !== start;
    findings.reset = (await key("0")) === start;
    const sliders = all(".slider input");
    POSITIONS.forEach((position, k) => {
        sliders[k].value = position;
        sliders[k].dispatchEvent(new Event("input", { bubbles: true }));
    });
    await settled();
    findings.moved = picture() !== start;
    findings.positions = sliders.map((slider) => Number(slider.value));
    findings.spoken = sliders.every((slider) => slider.getAttribute("aria-valuetext"));
    findings.origins = all("output[data-frame]").map((output) => JSON.parse(output.dataset.origin));
    document.querySelector(".home").click();
    await settled();
    findings.home = picture() === start;
"##;

fn check_common(name: &str, findings: &Findings) {
    let Findings { result, console } = findings;
    assert_eq!(console, &Vec::<String>::new(), "{name}: messages of the console");
    assert_eq!(result["failed"], Value::Null, "{name}");
    for nothing in ["loaded", "repeatedIds", "deadLinks", "empty", "nameless"] {
        assert_eq!(result[nothing], json!([]), "{name}: {nothing}");
    }
    assert_eq!(result["mathErrors"], 0, "{name}");
    assert_eq!(result["curves"], true, "{name}: curves without colour");
    let overflow = result["overflow"].as_i64().expect("a width");
    assert!(overflow <= 0, "{name}: {overflow} px wider than the window");
}

/// A page with one of everything.
fn sample() -> String {
    let line = |f: fn(f64) -> f64| (0..200).map(|k| 0.05 * f64::from(k)).map(|x| [x, f(x)]).collect();
    let plot = Plot::new("Torque", Axis::new("time", "s"), Axis::new("torque", "N m"))
        .series("feed-forward", Marks::Line, line(f64::sin))
        .series("controller", Marks::Dashed, line(f64::cos))
        .series("held", Marks::Steps, line(|x| x.sin().round()))
        .series("samples", Marks::Points, line(|x| 0.3 * x.cos()));
    let pareto = Plot::new("", Axis::new("λ", "").logarithmic(), Axis::new("error", "rad").logarithmic())
        .series("front", Marks::Line, (1..50).map(|k| [f64::from(k), 1.0 / f64::from(k)]).collect());
    let claim = |id: &str, value: f64| {
        Claim::new(id, "The error $e$ is small.")
            .criterion(Criterion::at_most("error", value, 1.0, "rad"))
            .flipped_by("no delay")
            .shown_in("torques")
    };
    let rows = (0..4).map(|k| vec![gelenk_report::Cell::Count(k), gelenk_report::Cell::number(0.1)]);
    let identity = (0..12).map(|i| (0..12).map(|j| i == j).collect()).collect();
    Report::new("Everything <at> once")
        .lead("With $\\dot x = A x + B_x u + c$ and `code`.")
        .fact("samples", "1220")
        .section(Section::new("claims", "Claims").block(Block::Claims(vec![
            claim("first", 0.5),
            claim("second", 0.5).under("the delay is known"),
            claim("third", 2.0).remark("It is `not` small."),
            claim("fourth", f64::NAN),
        ])))
        .section(
            Section::new("rest", "The rest")
                .block(Block::Equations(vec![
                    Equation::new(
                        r"\begin{bmatrix} a_{11} & \frac{1}{2} \\ 0 & \sum_{k=1}^{N} \|r_k\|^2 \end{bmatrix}",
                    )
                    .expect("an equation"),
                ]))
                .block(Block::Figure(Figure::new("torques", "Torques over time.").plot(plot).plot(pareto)))
                .block(Block::Patterns(vec![Pattern::new("eye", "$I$", vec![], vec![], identity)]))
                .block(Block::Table(
                    Table::new("table", "Values of $x$.")
                        .column("", "index", "")
                        .column("$x$", "x", "m")
                        .rows(rows),
                ))
                .block(Block::Details { summary: vec![], is_open: false, blocks: vec![text("folded $x^2$")] })
                .block(Block::Code("let x = 1 < 2;".to_owned())),
        )
        .html()
        .expect("the page")
}

#[test]
fn a_page_with_everything_is_sound() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let page = sample();
    let script = format!("{COMMON} return findings;");
    let light = browser.visit(&page, &script, WIDE);
    let dark = browser.visit(&page, &script, NARROW);
    for (name, findings) in [("light", &light), ("dark", &dark)] {
        check_common(name, findings);
        assert_eq!(findings.result["title"], "Everything <at> once");
        assert_eq!(findings.result["plots"], 2);
        let verdicts = ["✓ holds", "◐ holds under a condition", "✗ does not hold", "✗ does not hold"];
        assert_eq!(findings.result["verdicts"], json!(verdicts));
    }
    assert_ne!(light.result["background"], dark.result["background"]);
}

/// The checks above find each deliberate mistake.
#[test]
fn mistakes_are_found() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let script = format!("{COMMON} return findings;");
    let mistake = |tag: &str| {
        let page = sample().replace("</main>", &format!("{tag}</main>"));
        browser.visit(&page, &script, NARROW)
    };
    let loads = mistake("<img alt='x' src='https://example.org/x.png'>");
    assert!(!loads.console.is_empty(), "the browser says nothing about a refused load");
    assert!(!mistake("<script>nothing.at.all()</script>").console.is_empty());
    let wide = mistake("<div style='width: 900px; height: 1px'></div>");
    assert!(wide.result["overflow"].as_i64().expect("a width") > 0);
    assert_ne!(mistake("<a href='#nowhere'>x</a>").result["deadLinks"], json!([]));
    assert_ne!(mistake("<canvas width='0' height='0'></canvas>").result["empty"], json!([]));
    assert_ne!(mistake("<button></button>").result["nameless"], json!([]));
}

struct RobotPage {
    html: String,
    /// Positions within the limits, and the origins of the named frames there.
    positions: Vec<f64>,
    origins: Vec<Vec<f64>>,
}

/// Positions y where sliders displace and turn bodies along x, y and z, one after the other.
fn displaced(model: &Model, sliders: &[f64]) -> Vec<f64> {
    let mut y = vec![];
    let mut next = 0;
    while next < sliders.len() {
        let starts_here = |joint: &&QuaternionJoint| joint.coordinates().start == next;
        let Some(joint) = model.quaternion_joints.iter().find(starts_here) else {
            y.push(sliders[next]);
            next += 1;
            continue;
        };
        let of_joint = &sliders[joint.coordinates()];
        let (place, angles) = of_joint.split_at(of_joint.len() - 3);
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let turns =
            axes.iter().zip(angles).map(|(axis, angle)| UnitQuaternion::from_axis_angle(axis, *angle));
        y.extend(place);
        y.extend(turns.fold(UnitQuaternion::identity(), |all, turn| all * turn).coords.iter());
        next = joint.coordinates().end;
    }
    y
}

fn robot_page(name: &str) -> RobotPage {
    let path = workspace().join("models").join(format!("{name}.toml"));
    let loaded = read(&path, &ReadOptions::default()).unwrap_or_else(|problems| panic!("{problems}"));
    let functions = selection::derive_functions(&loaded.model, &[], MOST_OPERATIONS)
        .unwrap_or_else(|problems| panic!("{problems}"));
    let contents = Contents {
        model: &loaded.model,
        functions: &functions,
        notes: &loaded.notes,
        closed_form: Err("None are made here."),
        command: "gelenk report",
    };
    let html = report(&contents).and_then(|page| page.html()).expect("the page");
    let model = &loaded.model;
    let joints = model.coordinates.iter().filter_map(|&link| model.links[link].joint.as_ref());
    let positions: Vec<f64> = joints
        .map(|joint| {
            let [low, high] = joint.limits.position.unwrap_or([-0.5, 0.5]);
            low + 0.6 * (high - low)
        })
        .collect();
    let at = displaced(model, &positions);
    let parameters: Vec<f64> = model.parameters.iter().map(|one| one.default).collect();
    let origin = |frame: &gelenk_codegen::model::Frame| {
        let name = format!("frame_{}_pose", frame.identifier);
        let function = functions.iter().find(|function| function.name == name).expect("a pose");
        gelenk_codegen::program::interpret::interpret(&function.program, &[&at], &parameters)
            .expect("a pose")
            .swap_remove(0)
    };
    RobotPage { origins: model.frames.iter().map(origin).collect(), positions, html }
}

fn check_close(name: &str, found: &Value, expected: &[f64]) {
    let found = found.as_array().expect("numbers");
    assert_eq!(found.len(), expected.len(), "{name}");
    for (found, expected) in found.iter().zip(expected) {
        let found = found.as_f64().expect("a number");
        assert!((found - expected).abs() < 1e-9, "{name}: {found}, not {expected}");
    }
}

/// The view's own kinematics are those of the generated code.
fn check_robot(browser: &Browser, name: &str, window: Window) {
    let page = robot_page(name);
    let positions = json!(page.positions);
    let script = format!("const POSITIONS = {positions}; {COMMON} {ROBOT} return findings;");
    let findings = browser.visit(&page.html, &script, window);
    check_common(name, &findings);
    let result = &findings.result;
    for yes in ["focusable", "turned", "zoomed", "reset", "moved", "spoken", "home"] {
        assert_eq!(result[yes], true, "{name}: {yes}");
    }
    assert!(result["colours"].as_u64() > Some(20), "{name}: an empty view");
    // A slider's value is its least plus steps, rounded.
    check_close(name, &result["positions"], &page.positions);
    let origins = result["origins"].as_array().expect("origins");
    assert_eq!(origins.len(), page.origins.len(), "{name}");
    for (found, expected) in origins.iter().zip(&page.origins) {
        check_close(name, found, expected);
    }
    let verdicts = result["verdicts"].as_array().expect("verdicts");
    assert!(verdicts.len() >= 7, "{name}: {verdicts:?}");
    assert!(verdicts.iter().all(|verdict| verdict == "✓ holds"), "{name}: {verdicts:?}");
}

#[test]
fn pages_of_robots_are_sound_and_move() {
    let Some(browser) = Browser::find() else {
        return;
    };
    // Fingers of the gripper follow; cylinders of the excavator are lines.
    for name in [
        "powercube",
        "cart_pole",
        "puma560",
        "two_arm",
        "panda",
        "double_pendulum",
        "scara",
        "gripper",
        "excavator",
    ] {
        check_robot(&browser, name, WIDE);
    }
    check_robot(&browser, "powercube", NARROW);
    check_robot(&browser, "ur5", NARROW);
}

/// A base that floats has six sliders, and a ball joint three.
#[test]
fn pages_of_robots_with_quaternions_move() {
    let Some(browser) = Browser::find() else {
        return;
    };
    assert_eq!(robot_page("quadrotor").positions.len(), 6);
    check_robot(&browser, "quadrotor", WIDE);
    check_robot(&browser, "satellite", WIDE);
}

#[test]
fn pages_can_be_printed() {
    let Some(browser) = Browser::find() else {
        return;
    };
    let pages = browser.print(&robot_page("powercube").html);
    assert!((3..=12).contains(&pages), "{pages} pages");
}

/// The paper's page, as the program `powercube` wrote it. `GELENK_REPORT` names its folder; in CI it must.
fn paper_page() -> Option<String> {
    let Some(folder) = std::env::var_os("GELENK_REPORT") else {
        assert!(
            std::env::var_os("CI").is_none(),
            "GELENK_REPORT must name the folder that the example `powercube` wrote"
        );
        println!("skipped: GELENK_REPORT names no folder of the example `powercube`");
        return None;
    };
    let file = workspace().join(folder).join("index.html");
    Some(std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display())))
}

#[test]
fn the_paper_s_page_is_sound_and_complete() {
    let Some(page) = paper_page() else {
        return;
    };
    let Some(browser) = Browser::find() else {
        return;
    };
    let script = format!(
        r#"{COMMON}
        findings.claims = all("table.claims tbody tr").map((row) => row.id);
        findings.unshown = all("table.claims a").map((a) => a.getAttribute("href").slice(1))
            .filter((id) => !document.getElementById(id)?.closest("figure, .table, table, div"));
        findings.figures = all("figure").length;
        findings.drawn = all("figure").every((figure) => figure.querySelector("svg.plot") && figure.querySelector("figcaption"));
        findings.sections = all("main section").length;
        return findings;"#
    );
    let light = browser.visit(&page, &script, WIDE);
    let dark = browser.visit(&page, &script, NARROW);
    for (name, findings) in [("light", &light), ("dark", &dark)] {
        check_common(name, findings);
        let result = &findings.result;
        let claims = result["claims"].as_array().expect("claims");
        let named = |number: usize| {
            claims.iter().filter_map(Value::as_str).any(|id| {
                let label = id.strip_prefix("claim-").expect("a number");
                label.trim_end_matches(|c: char| c.is_ascii_lowercase()) == number.to_string()
            })
        };
        let missing: Vec<usize> = (1..=12).filter(|number| !named(*number)).collect();
        assert_eq!(missing, Vec::<usize>::new(), "{name}: claims without a row");
        assert_eq!(result["unshown"], json!([]), "{name}: claims without their figure");
        assert_eq!(result["drawn"], true, "{name}: figures without plot or caption");
        assert!(result["figures"].as_u64() >= Some(20), "{name}: {result}");
        assert!(result["math"].as_u64() >= Some(12), "{name}: equations");
        let verdicts = result["verdicts"].as_array().expect("verdicts");
        assert_eq!(verdicts.len(), claims.len(), "{name}");
    }
    assert_ne!(light.result["background"], dark.result["background"]);
    let pages = browser.print(&page);
    assert!((5..=60).contains(&pages), "{pages} pages");
}
