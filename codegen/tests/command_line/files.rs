//! Files that are written, and those that are kept.

use super::{gelenk, refused, shown};
use std::fs;
use std::process::Command;

/// A pendulum: small enough that its page is made in no time.
const PENDULUM: &str = "[[joints]]\nname = \"swing\"\naxis = [0, 1, 0]\ndrive = \"ideal\"\nfriction = \"0.1*v + 0.2*sign(v)\"\n\
    [[bodies]]\nlink = \"swing\"\nmass = 1\ncenter_of_mass = [0, 0, -0.5]\n";

#[test]
fn a_page_and_its_numbers_are_written() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    let output = gelenk(folder.path(), &["report", "pendulum.toml", "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(said["files"][0], "report/pendulum/index.html");
    for check in said["self_check"].as_array().unwrap() {
        assert_eq!(check["verdict"], "holds", "{check}");
    }
    let read = |name: &str| fs::read_to_string(folder.path().join("report/pendulum").join(name)).unwrap();
    let data: serde_json::Value = serde_json::from_str(&read("report.json")).unwrap();
    assert_eq!(data["title"], "Equations of motion of pendulum");
    assert!(read("index.html").contains("gelenk report pendulum.toml"));
    assert!(read("bodies.csv").starts_with("body,link,mass [kg],c_x [m]"), "{}", read("bodies.csv"));
    // Choices that change the equations are those of `generate`, and stand at the foot of the page.
    let smooth = ["report", "pendulum.toml", "--smooth-sign", "80", "--output", "smooth"];
    assert_eq!(gelenk(folder.path(), &smooth).status.code(), Some(0));
    let smooth = fs::read_to_string(folder.path().join("smooth/report.json")).unwrap();
    assert!(smooth.contains(r"\\tanh\\left(80"), "{smooth}");
    assert!(smooth.contains("gelenk report pendulum.toml --smooth-sign 80.0"));
    // The same description, the same bytes.
    let first = read("index.html");
    gelenk(folder.path(), &["report", "pendulum.toml", "--output", "again"]);
    assert_eq!(first, fs::read_to_string(folder.path().join("again/index.html")).unwrap());
}

/// Losses in other formats are reported, and so is each written file.
#[test]
fn a_ball_in_a_urdf_is_refused_by_others() {
    let folder = tempfile::tempdir().unwrap();
    let ball = "[[joints]]\nname = \"top\"\ntype = \"spherical\"\n[[bodies]]\nlink = \"top\"\nmass = 1\ninertia = 1\n";
    fs::write(folder.path().join("ball.toml"), ball).unwrap();
    let said = shown(&gelenk(folder.path(), &["export", "ball.toml", "--urdf", "--output", "ball.urdf"]));
    assert!(said.contains("urdfdom and Pinocchio refuse the whole file for: `top`"), "{said}");
    let said = shown(&gelenk(folder.path(), &["generate", "ball.toml", "--functions", "integrate"]));
    assert!(said.contains("written in any case for robots with spherical or floating joints"), "{said}");
}

#[test]
fn a_page_that_cannot_be_written_ends_with_1() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("pendulum.toml"), PENDULUM).unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    let output = gelenk(folder.path(), &["report", "pendulum.toml", "--output", "taken"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("cannot write taken") && said.contains("--output FOLDER"), "{said}");
    let output = gelenk(folder.path(), &["report", "none.toml"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.path().join("report").exists());
}

/// Input files and files that gelenk did not generate are never overwritten.
#[test]
fn descriptions_and_foreign_files_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("base.toml"), PENDULUM).unwrap();
    let extension = "extends = \"base.toml\"\n";
    fs::write(at("arm.toml"), extension).unwrap();
    fs::write(at("main.rs"), "fn main() {}\n").unwrap();
    fs::write(at("empty.rs"), "").unwrap();
    let generate = |output: &str| refused(folder.path(), &["generate", "arm.toml", "-o", output]);
    for output in ["arm.toml", "./arm.toml", "base.toml"] {
        let said = generate(output);
        assert!(said.contains("read"), "{said}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("arm.toml", at("symbolic.rs")).unwrap();
        fs::hard_link(at("base.toml"), at("hard.rs")).unwrap();
        let said = generate("symbolic.rs");
        assert!(said.contains("symbolic.rs: it is arm.toml, which was read"), "{said}");
        let said = generate("hard.rs");
        assert!(said.contains("hard.rs: it is base.toml, which was read"), "{said}");
    }
    let said = generate("main.rs");
    assert!(said.contains("main.rs: gelenk has not generated it"), "{said}");
    fs::write(at("arm.rs"), "fn mine() {}\n").unwrap();
    let said = generate(".");
    assert!(said.contains("arm.rs: gelenk has not generated it"), "{said}");
    // A name without an ending is a folder that is made.
    assert!(gelenk(folder.path(), &["generate", "arm.toml", "-o", "src"]).status.success());
    assert!(at("src/arm.rs").is_file());
    // The smooth module of a pair is written to a name that nobody gave.
    fs::write(at("new_control.rs"), "fn mine() {}\n").unwrap();
    let pair = ["generate", "arm.toml", "-o", "new.rs", "--control-model", "50"];
    let said = refused(folder.path(), &pair);
    assert!(said.contains("new_control.rs: gelenk has not generated it"), "{said}");
    assert!(!at("new.rs").exists(), "one of two was written");
    for (file, text) in [("base.toml", PENDULUM), ("arm.toml", extension), ("main.rs", "fn main() {}\n")] {
        assert_eq!(fs::read_to_string(at(file)).unwrap(), text);
    }
    for output in ["empty.rs", "new.rs", "new.rs"] {
        let made = gelenk(folder.path(), &["generate", "arm.toml", "-o", output]);
        assert_eq!(made.status.code(), Some(0), "{}", shown(&made));
    }
}

/// A folder that looks like a workspace may have a crate root of its own.
#[test]
fn a_foreign_crate_root_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["models", "generated/src"] {
        fs::create_dir_all(at(name)).unwrap();
    }
    fs::write(at("models/pendulum.toml"), PENDULUM).unwrap();
    fs::write(at("generated/src/lib.rs"), "pub mod mine;\n").unwrap();
    for arguments in [&["generate"][..], &["generate", "models/pendulum.toml"]] {
        let said = refused(folder.path(), arguments);
        assert!(said.contains("lib.rs: gelenk has not generated it"), "{said}");
        assert!(!at("generated/src/pendulum.rs").exists());
    }
    assert_eq!(fs::read_to_string(at("generated/src/lib.rs")).unwrap(), "pub mod mine;\n");
}

/// The exact model and the smooth one, in one command; `check` knows both.
#[test]
fn a_plant_and_a_controller_have_models_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let smooth = format!("{PENDULUM}[generate]\nsmooth_sign = 5\n");
    fs::write(folder.path().join("pendulum.toml"), smooth).unwrap();
    let pair = ["pendulum.toml", "--control-model", "50", "--output", "arm.rs"];
    let run = |command: &str| {
        let output = gelenk(folder.path(), &[&[command], &pair[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", shown(&output));
    };
    run("generate");
    run("check");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let (exact, smooth) = (read("arm.rs"), read("arm_control.rs"));
    assert!(exact.contains("The exact model, for plants."), "{exact}");
    assert!(!exact.contains("math::tanh(") && exact.contains("sign(v[0])"));
    assert!(smooth.contains("tanh(50 v) stands for the sign(v) of pendulum"));
    assert!(smooth.contains("v[0] * 50.0") && smooth.contains("tanh("), "{smooth}");
    fs::remove_file(folder.path().join("arm_control.rs")).unwrap();
    let stale = refused(folder.path(), &[&["check"], &pair[..]].concat());
    assert!(stale.contains("missing: arm_control.rs"), "{stale}");
    let piped = ["generate", "pendulum.toml", "--control-model", "50", "-o", "-"];
    assert_eq!(gelenk(folder.path(), &piped).status.code(), Some(2));
}

/// On a full disk the old page and the old module stay as they were. A limit on the size of files stands for
/// the disk.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("pendulum.toml"), PENDULUM).unwrap();
    let commands = ["report pendulum.toml", "generate pendulum.toml"];
    for command in commands {
        let words: Vec<&str> = command.split(' ').collect();
        assert_eq!(gelenk(folder.path(), &words).status.code(), Some(0));
    }
    let files = || {
        let mut files = Vec::new();
        for folder in [folder.path().to_owned(), at("report/pendulum")] {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let content = fs::read(&path).unwrap_or_default();
                files.push((path, content));
            }
        }
        files.sort();
        files
    };
    fs::write(at("pendulum.toml"), PENDULUM.replace("mass = 1", "mass = 2")).unwrap();
    let before = files();
    for command in commands {
        // The signal of the limit is ignored, so that writing fails as on a full disk.
        let script = format!("trap '' XFSZ; ulimit -f 8; exec \"$0\" {command}");
        let output = Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_gelenk")])
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
        assert!(shown(&output).contains("cannot write"), "{}", shown(&output));
        assert_eq!(files(), before, "{command}");
    }
    // What is meant to stay is not replaced either.
    let mut rights = fs::metadata(at("pendulum.rs")).unwrap().permissions();
    rights.set_readonly(true);
    fs::set_permissions(at("pendulum.rs"), rights).unwrap();
    let said = refused(folder.path(), &["generate", "pendulum.toml"]);
    assert!(said.contains("pendulum.rs: it is read-only"), "{said}");
    assert_eq!(files(), before);
}

/// The file is written anew over one of its own, and over nothing else.
#[test]
fn an_export_writes_over_exports_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("arm.toml"), include_str!("../../src/cli/template/robot.toml")).unwrap();
    fs::write(path("mine.xml"), "<mujoco/>\n").unwrap();
    let export = |words: &[&str]| gelenk(folder.path(), &[&["export", "arm.toml"], words].concat());
    for format in ["--mjcf", "--urdf"] {
        let output = ["out", &format[2..]].join(".");
        for said in ["wrote", "unchanged"] {
            let done = export(&[format, "--output", &output]);
            assert_eq!(done.status.code(), Some(0), "{}", shown(&done));
            assert!(shown(&done).contains(said), "{}", shown(&done));
        }
        fs::write(path(&output), fs::read_to_string(path(&output)).unwrap() + "<!-- older -->").unwrap();
        assert!(shown(&export(&[format, "--output", &output])).contains("wrote"));
        for (file, why) in [("mine.xml", "has not generated"), ("arm.toml", "was read from it")] {
            let before = fs::read(path(file)).unwrap();
            let refused = export(&[format, "--output", file]);
            assert_eq!(refused.status.code(), Some(1), "{}", shown(&refused));
            assert!(shown(&refused).contains(why), "{}", shown(&refused));
            assert_eq!(fs::read(path(file)).unwrap(), before);
        }
    }
    for words in [&[][..], &["--mjcf", "--urdf"]] {
        assert_eq!(export(words).status.code(), Some(2));
    }
    let described = fs::read_to_string(path("arm.toml")).unwrap();
    // A motor of 0.4 N m behind a gear of 50 gives 20 N m, whatever the joint bears.
    fs::write(path("arm.toml"), described.replace("effort = 20", "effort = 90")).unwrap();
    let exported = String::from_utf8(export(&["--urdf", "--output", "-"]).stdout).unwrap();
    assert!(exported.contains("effort=\"20\""), "{exported}");
    let driven = "name = \"shoulder\"\nmotion = \"driven\"\n";
    fs::write(
        path("arm.toml"),
        described.replacen("name = \"shoulder\"\n", driven, 1).replacen("drive =", "# drive =", 1),
    )
    .unwrap();
    let refused = export(&["--mjcf"]);
    assert!(
        shown(&refused).contains("a robot is not exported, because joints are driven"),
        "{}",
        shown(&refused)
    );
}
