//! Constants of a module: sizes, names, limits, drives.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::context::Context;
use super::doc_comment::DocComment;
use super::lints;
use crate::model::{Drive, Input, Joint, Model};

/// Names of all constants that a module can have.
pub(super) const NAMES: [&str; 17] = [
    "N",
    "M",
    "JOINT_NAMES",
    "JOINT_UNITS",
    "INPUT_NAMES",
    "INPUT_UNITS",
    "INPUT_JOINTS",
    "FRAME_NAMES",
    "POSITION_LIMITS",
    "VELOCITY_LIMITS",
    "EFFORT_LIMITS",
    "PEAK_EFFORT_LIMITS",
    "INPUT_LIMITS",
    "PEAK_INPUT_LIMITS",
    "GEAR_RATIOS",
    "ROTOR_INERTIAS",
    "GRAVITY",
];

/// All constants, in the order in which a reader asks for them.
pub(super) fn items(context: &Context<'_>) -> Vec<TokenStream> {
    let model = context.model;
    let joints: Vec<&Joint> = model.joints().collect();
    let inputs: Vec<&Drive> = model.inputs().collect();
    let mut items = sizes(context);
    items.extend(names(model, &joints, &inputs));
    items.extend(joint_limits(context, &joints));
    items.extend(drives(context, &inputs));
    items.extend(gravity(context));
    items
}

fn sizes(context: &Context<'_>) -> Vec<TokenStream> {
    let n = proc_macro2::Literal::usize_unsuffixed(context.model.coordinates.len());
    let m = proc_macro2::Literal::usize_unsuffixed(context.model.inputs().count());
    vec![
        quote! {
            #[doc = " Number of coordinates."]
            pub const N: usize = #n;
        },
        quote! {
            #[doc = " Number of inputs."]
            pub const M: usize = #m;
        },
    ]
}

fn names(model: &Model, joints: &[&Joint], inputs: &[&Drive]) -> Vec<TokenStream> {
    let joint_names = joints.iter().map(|joint| joint.name.as_str());
    let joint_units = joints.iter().map(|joint| joint.kind.unit());
    let input_names = inputs.iter().map(|drive| drive.name.as_str());
    let input_units = inputs.iter().map(|drive| model.input_unit(drive));
    let input_joints = inputs
        .iter()
        .filter_map(|drive| drive.coordinate)
        .map(proc_macro2::Literal::usize_unsuffixed);
    let frame_names = model.frames.iter().map(|frame| frame.name.as_str());
    let frame_count = proc_macro2::Literal::usize_unsuffixed(model.frames.len());
    let mut items = vec![
        quote! {
            #[doc = " Names of the joints, in the order of the coordinates."]
            pub const JOINT_NAMES: [&str; N] = [#(#joint_names),*];
        },
        quote! {
            #[doc = " Units of the coordinates: `rad` or `m`."]
            pub const JOINT_UNITS: [&str; N] = [#(#joint_units),*];
        },
        quote! {
            #[doc = " Names of the inputs."]
            pub const INPUT_NAMES: [&str; M] = [#(#input_names),*];
        },
        quote! {
            #[doc = " Units of the inputs: `N m` or `N` for ideal drives and motor torques, `A` for motor currents."]
            pub const INPUT_UNITS: [&str; M] = [#(#input_units),*];
        },
        quote! {
            #[doc = " The coordinate that each input acts on."]
            pub const INPUT_JOINTS: [usize; M] = [#(#input_joints),*];
        },
    ];
    if !model.frames.is_empty() {
        items.push(quote! {
            #[doc = " Names of the frames."]
            pub const FRAME_NAMES: [&str; #frame_count] = [#(#frame_names),*];
        });
    }
    items
}

fn joint_limits(context: &Context<'_>, joints: &[&Joint]) -> Vec<TokenStream> {
    let n = format_ident!("N");
    let velocity = joints.iter().map(|joint| joint.limits.velocity);
    let effort = joints.iter().map(|joint| joint.limits.effort);
    let peak = joints
        .iter()
        .map(|joint| joint.limits.peak_effort.or(joint.limits.effort));
    let or_infinite = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
    let velocity_text = "Highest speed of each joint (rad/s or m/s); infinite where not described.";
    let effort_text = "Nominal force at each joint (N m or N); infinite where not described.";
    let peak_text =
        "Peak force at each joint (N m or N); the nominal one where no peak is described.";
    vec![
        position_limits(context, joints),
        vector(
            context,
            "VELOCITY_LIMITS",
            velocity_text,
            &n,
            velocity.map(or_infinite),
        ),
        vector(
            context,
            "EFFORT_LIMITS",
            effort_text,
            &n,
            effort.map(or_infinite),
        ),
        vector(
            context,
            "PEAK_EFFORT_LIMITS",
            peak_text,
            &n,
            peak.map(or_infinite),
        ),
    ]
}

fn position_limits(context: &Context<'_>, joints: &[&Joint]) -> TokenStream {
    let scalar = context.options.scalar;
    let ty = scalar.ty();
    let unlimited = [f64::NEG_INFINITY, f64::INFINITY];
    let limits: Vec<[f64; 2]> = joints
        .iter()
        .map(|joint| joint.limits.position.unwrap_or(unlimited))
        .collect();
    let allowed = lints::for_numbers(limits.iter().flatten().copied());
    let rows = limits.iter().map(|[low, high]| {
        let (low, high) = (scalar.literal(*low), scalar.literal(*high));
        quote!([#low, #high])
    });
    quote! {
        #[doc = " Lowest and highest position of each joint (rad or m); infinite where not described."]
        #allowed
        pub const POSITION_LIMITS: [[#ty; 2]; N] = [#(#rows),*];
    }
}

/// Constants of the drives. Gear ratios and rotor inertias that depend on free parameters are left out; limits of
/// currents take the described motor constant.
fn drives(context: &Context<'_>, inputs: &[&Drive]) -> Vec<TokenStream> {
    let m = format_ident!("M");
    let described: Vec<f64> = context
        .model
        .parameters
        .iter()
        .map(|parameter| parameter.default)
        .collect();
    let all = |value: &dyn Fn(&Drive) -> Option<f64>| {
        inputs
            .iter()
            .map(|drive| value(drive))
            .collect::<Option<Vec<f64>>>()
    };
    let nominal = |drive: &Drive| drive.torque.nominal.unwrap_or(f64::INFINITY);
    let peak = |drive: &Drive| {
        drive
            .torque
            .peak
            .or(drive.torque.nominal)
            .unwrap_or(f64::INFINITY)
    };
    let constants = [
        (
            "INPUT_LIMITS",
            "Largest magnitude of each input that its motor bears continuously, in the unit of the input; infinite \
             where not described. `EFFORT_LIMITS` at the joint holds beside it.",
            all(&|drive| Some(nominal(drive) / torque_per_input(drive, &described)?)),
        ),
        (
            "PEAK_INPUT_LIMITS",
            "Largest magnitude of each input that its motor bears for a short time, in the unit of the input; the \
             nominal one where no peak is described.",
            all(&|drive| Some(peak(drive) / torque_per_input(drive, &described)?)),
        ),
        (
            "GEAR_RATIOS",
            "Gear ratio of each drive: motor angle over joint angle.",
            all(&|drive| drive.gear_ratio.value(&[])),
        ),
        (
            "ROTOR_INERTIAS",
            "Axial inertia of each rotor, on its own side of the gear [kg m²].",
            all(&|drive| drive.rotor_inertia.value(&[])),
        ),
    ];
    constants
        .into_iter()
        .filter_map(|(name, text, values)| {
            Some(vector(context, name, text, &m, values?.into_iter()))
        })
        .collect()
}

/// Motor torque per unit of input: 1, or the magnitude of the motor constant.
fn torque_per_input(drive: &Drive, described: &[f64]) -> Option<f64> {
    match &drive.input {
        Input::Torque => Some(1.0),
        Input::Current(motor_constant) => motor_constant.value(described).map(f64::abs),
    }
}

fn gravity(context: &Context<'_>) -> Option<TokenStream> {
    let values: Option<Vec<f64>> = context.model.gravity.iter().map(|g| g.value(&[])).collect();
    let three = quote!(3);
    Some(vector(
        context,
        "GRAVITY",
        "Gravitational acceleration in the base frame [m/s²].",
        &three,
        values?.into_iter(),
    ))
}

fn vector(
    context: &Context<'_>,
    name: &str,
    text: &str,
    len: &impl quote::ToTokens,
    values: impl Iterator<Item = f64>,
) -> TokenStream {
    let scalar = context.options.scalar;
    let name: Ident = format_ident!("{name}");
    let (ty, documentation) = (scalar.ty(), DocComment::new(text).tokens());
    let values: Vec<f64> = values.collect();
    let allowed = lints::for_numbers(values.iter().copied());
    let entries = values.iter().map(|&value| scalar.literal(value));
    quote! {
        #documentation
        #allowed
        pub const #name: [#ty; #len] = [#(#entries),*];
    }
}
