//! The tests of this package, as one program: it is linked once, and its tests share the processors.

mod acados;
mod array_forms;
mod ball_joints;
mod build_script;
#[path = "c_modules/main.rs"]
mod c_modules;
mod closed_form;
mod composition_counts;
mod counts;
mod determinism;
#[path = "discrete_time/main.rs"]
mod discrete_time;
mod documents;
mod driven;
mod driven_motion;
mod emitted;
mod emitted_options;
mod enumerated;
mod findings;
mod freshness;
mod friction;
mod identified_loop;
mod imports;
mod instructions;
mod lanes;
mod limits;
mod load_friction;
mod microcontrollers;
mod motion_on_manifolds;
mod mujoco;
mod new_crate;
mod new_floating_crate;
mod online_replay;
mod packages;
mod pages;
#[path = "properties/main.rs"]
mod properties;
mod python;
mod quaternion_properties;
#[path = "quaternions/main.rs"]
mod quaternions;
mod reactions;
mod reference;
mod regressors;
#[path = "robustness/main.rs"]
mod robustness;
mod second_order;
mod snapshots_of_text;
mod structure;
mod surface;
mod verified;

/// A file that no list has would never run.
#[test]
fn every_file_is_listed() {
    for package in ["tests", "codegen", "runtime"] {
        let folder = gelenk_tests::workspace().join(package).join("tests");
        let read = |path: &str| std::fs::read_to_string(folder.join(path)).unwrap_or_default();
        let (list, programs) = (format!("{}{}", read("all.rs"), read("loops.rs")), read("../Cargo.toml"));
        let mut count = 0;
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let is_test = path.extension().is_some_and(|end| end == "rs") || path.join("main.rs").exists();
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            if is_test {
                count += 1;
                let is_program = programs.contains(&format!("[[test]]\nname = \"{name}\"\n"));
                let is_listed = is_program || list.lines().any(|line| line.trim() == format!("mod {name};"));
                assert!(is_listed, "{package}/tests/all.rs lacks {name}");
            }
        }
        assert!(count > 25, "only {count} files in {folder:?}");
    }
}
