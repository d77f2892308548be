//! Scenes of an MJCF: the tree of one body is the robot; files of the scene are found as MuJoCo finds them.
#![allow(clippy::unwrap_used, reason = "a test's helpers fail with the test")]

use std::fs;

use gelenk_codegen::diagnostic::Diagnostics;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, read};

const SCENE: &str = r#"<mujoco model="scene">
  <asset><mesh file="absent.stl"/></asset>
  <worldbody>
    <body name="box" pos="1 0 0"><freejoint name="box"/><geom type="mesh" mesh="absent"/><geom size="0.1"/></body>
    <body name="stand" pos="0 0 0.5">
      <site name="tip"/>
      <body name="arm"><joint name="swing" axis="0 1 0"/><geom size="0.1" pos="0 0 0.2"/><include file="parts\\hand.xml"/></body>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="swing"/><motor name="other" joint="roll"/></actuator>
</mujoco>"#;
const HAND: &str =
    r#"<mujocoinclude><body name="hand" pos="0 0 0.4"><include file="finger.xml"/></body></mujocoinclude>"#;
const FINGER: &str =
    r#"<mujocoinclude><joint name="roll" axis="0 1 0"/><geom size="0.1" pos="0 0 0.2"/></mujocoinclude>"#;

fn of(file: &str, body: Option<&str>) -> Result<Model, Diagnostics> {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    let top = "extends = \"scene.xml\"\nbody = \"hand\"\n";
    let lone = "body = \"hand\"\n[[joints]]\nname = \"a\"\n[[bodies]]\nlink = \"a\"\nmass = 1\ninertia = 1\n";
    let files = [
        ("scene.xml", SCENE),
        ("parts/hand.xml", HAND),
        ("parts/finger.xml", FINGER),
        ("top.toml", top),
        ("lone.toml", lone),
    ];
    for (name, text) in files {
        fs::write(folder.path().join(name), text.replace("\\\\", "\\")).unwrap();
    }
    let options = ReadOptions { body: body.map(str::to_owned), ..ReadOptions::default() };
    read(&folder.path().join(file), &options).map(|loaded| loaded.model)
}

#[test]
fn the_tree_of_a_body_is_the_robot() {
    let names = |model: &Model| model.links.iter().map(|link| link.name.clone()).collect::<Vec<_>>();
    assert_eq!(of("scene.xml", None).unwrap().coordinates.len(), 8);
    for (file, body) in [("scene.xml", Some("stand")), ("scene.xml", Some("hand")), ("top.toml", None)] {
        let model = of(file, body).unwrap();
        assert_eq!(names(&model), ["world", "stand", "arm", "hand"]);
        assert_eq!((model.coordinates.len(), model.drives.len(), model.frames.len()), (2, 2, 1));
    }
    let model = of("scene.xml", Some("box")).unwrap();
    assert_eq!((names(&model).len(), model.coordinates.len(), model.drives.len()), (7, 6, 0));
}

#[test]
fn bodies_that_are_no_part_of_a_scene_are_refused() {
    let code = |file: &str, body| of(file, body).unwrap_err().entries()[0].code;
    assert_eq!(code("scene.xml", Some("hnad")), "unknown-link");
    assert_eq!(code("scene.xml", Some("world")), "unknown-link");
    assert_eq!(code("lone.toml", None), "body-without-scene");
    assert_eq!(code("lone.toml", Some("hand")), "body-without-scene");
}
