//! Words of URDF and MJCF that no reader uses are reported: a value under a wrong name makes another robot.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use gelenk_codegen::diagnostic::Diagnostic;
use gelenk_codegen::model::Model;
use gelenk_codegen::read::{ReadOptions, from_mjcf, from_urdf};

/// Messages about a URDF with these lines in a joint and in an inertial.
fn told(joint: &str, inertial: &str) -> String {
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\"><inertial>{inertial}<mass value=\"1\"/></inertial></link>\
         <joint name=\"other\" type=\"continuous\"><parent link=\"base\"/><child link=\"two\"/><axis xyz=\"0 0 1\"/></joint>\
         <link name=\"two\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
         <joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/>{joint}</joint></robot>"
    );
    let (_, notes) =
        from_urdf(&text, "r.urdf", &ReadOptions::default()).unwrap_or_else(|wrong| panic!("{wrong}"));
    notes.to_string()
}

#[test]
fn attributes_of_a_urdf_that_nobody_reads_are_told() {
    let inertial = "<origin xyz=\"0 1 0\"/>";
    let axis = "<axis xyz=\"0 0 1\"/>";
    for (joint, inertial, said) in [
        ("<origin xzy=\"0 0 1\"/>", inertial, "<origin xzy> (did you mean `xyz`?)"),
        ("<origin xyz=\"0 0 1\" rpv=\"0 0 1\"/>", inertial, "<origin rpv> (did you mean `rpy`?)"),
        ("<origin quat_wxyz=\"1 0 0 0\"/>", inertial, "<origin quat_wxyz>"),
        ("<limit low=\"-1\" upper=\"1\"/>", inertial, "<limit low> (did you mean `lower`?)"),
        ("<dynamics dampng=\"3\"/>", inertial, "<dynamics dampng> (did you mean `damping`?)"),
        (
            "<mimic joint=\"other\" mult=\"3\" ofset=\"1\"/>",
            inertial,
            "<mimic mult> (did you mean `multiplier`?), <mimic ofset> (did you mean `offset`?)",
        ),
        ("", "<origin xy=\"0 1 0\"/>", "<origin xy> (did you mean `xyz`?)"),
        ("<orign xyz=\"0 0 1\"/>", inertial, "<orign> (did you mean `origin`?)"),
        ("", "<origin xyz=\"0 1 0\"/><inertai/>", "<inertai> (did you mean `inertia`?)"),
    ] {
        let notes = told(&format!("{axis}{joint}"), inertial);
        assert!(notes.contains(said), "{said}: {notes}");
    }
    let notes = told("<axis xzy=\"0 0 1\"/>", inertial);
    assert!(notes.contains("<axis xzy> (did you mean `xyz`?)"), "{notes}");
    assert!(
        notes.contains("warning[axis-missing]: an <axis> without `xyz` was read as the x axis: `j`"),
        "{notes}"
    );
    let usual =
        "<origin xyz=\"0 0 1\" rpy=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";
    let notes = told(&format!("{axis}{usual}<dynamics damping=\"1\" friction=\"1\"/>"), inertial);
    assert!(!notes.contains("unknown elements"), "{notes}");
}

fn mjcf(text: &str) -> Result<Model, String> {
    let mut load = |file: &str| Err(Diagnostic::error("file-unreadable", file).into());
    let read = from_mjcf(text, "r.xml", &ReadOptions::default(), &mut load);
    read.map(|(model, _)| model).map_err(|wrong| wrong.to_string())
}

/// As in MuJoCo: of a class the orientation counts that the element does not replace.
#[test]
fn an_orientation_replaces_that_of_the_class() {
    let moments = |class: &str, own: &str| {
        let text = format!(
            "<mujoco><compiler angle=\"radian\"/><default><geom type=\"box\" {class}/></default><worldbody><body><joint/>\
             <geom size=\"0.1 0.2 0.3\" {own}/></body></worldbody></mujoco>"
        );
        let model = mjcf(&text).unwrap();
        let inertia = &model.links[1].bodies[0].inertia;
        [0, 3, 5].map(|entry| inertia[entry].evaluate(&[], 0.0, 0.0))
    };
    let [plain, about_x, about_z] =
        ["", "euler=\"1.5707963267948966 0 0\"", "euler=\"0 0 1.5707963267948966\""]
            .map(|own| moments("", own));
    assert!(plain[0] > plain[1] && plain[1] > plain[2]);
    assert!((about_z[0] - plain[1]).abs() < 1e-9 && (about_x[1] - plain[2]).abs() < 1e-9);
    let class = "quat=\"1 1 0 0\"";
    let close =
        |found: [f64; 3], wanted: [f64; 3]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(close(moments(class, ""), about_x));
    assert!(close(moments(class, "euler=\"0 0 1.5707963267948966\""), about_z));
    assert!(close(moments("euler=\"1 0 0\"", "zaxis=\"0 -1 0\""), about_x));
}

/// Names that MuJoCo has, or had, are taken, and elements that are not read may say what they like.
#[test]
fn what_mujoco_knows_is_taken() {
    let text = r#"<mujoco model="m"><compiler angle="radian" meshdir="m" convexhull="true"/><option timestep="0.001"><flag eulerdamp="disable"/></option>
        <size nconmax="9"/><visual><anything at="all"/></visual>
        <default><joint damping="1" solreflimit="0 1"/><motor ctrlrange="-1 1"/><default class="c"><geom contype="0"/><site rgba="1 0 0 1"/></default></default>
        <worldbody><light pos="0 0 1" whatever="1"/><body name="a" childclass="c" gravcomp="0"><joint name="j" actuatorfrcrange="-1 1" group="1"/>
        <geom size="0.1" friction="1 0 0" priority="1"/><site name="s" type="sphere"/><camera fovy="1"/></body></worldbody>
        <tendon><fixed name="t" rgba="1 0 0 1"><joint joint="j" coef="1"/></fixed></tendon>
        <actuator><position joint="j" kp="1" dampratio="1" inheritrange="1"/><general joint="j" gainprm="1" biasprm="0 0 0"/><muscle joint="j" lmin="0.5"/></actuator>
        <sensor><jointpos joint="j"/></sensor></mujoco>"#;
    mjcf(text).unwrap_or_else(|wrong| panic!("{wrong}"));
    let wrong = mjcf(&text.replace("kp=", "kpp=").replace("<motor ", "<moter ")).unwrap_err();
    assert!(
        wrong.contains("unknown attribute `kpp` of <position>") && wrong.contains("did you mean `kp`?"),
        "{wrong}"
    );
    assert!(wrong.contains("unknown element <moter>") && wrong.contains("did you mean `motor`?"), "{wrong}");
}
