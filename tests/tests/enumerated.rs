//! Chains of joints of every type, one behind the other, in every special direction and place: every function against the equations
//! of Poincaré, as straight-line code and as loops over joints.
//!
//! The short form takes each pair of types in one direction, and the functions of frames in all. All pairs, with joints that follow
//! and driven ones in each place, all triples of hinges, slides, balls and floating joints, and others by chance:
//!
//! ```text
//! cargo test --release -p gelenk-tests --test all enumerated:: -- --ignored --nocapture
//! ```
//!
//! `GELENK_CHAINS=3/20` takes the third of twenty parts.

use fastrand::Rng;
use gelenk_codegen::model::Model;
use gelenk_tests::agreement::truth::State;
use gelenk_tests::agreement::{a_third, assert_agreement, functions, is_of_frame};
use gelenk_tests::enumerated::{Chain, DIRECTIONS, Origin, Role, TYPES};
use gelenk_tests::in_parallel;

/// Chains of two joints in one direction and place.
fn pairs(direction: usize, origin: Origin, roles: [Role; 2]) -> impl Iterator<Item = Chain> {
    let types = TYPES.iter().flat_map(|a| TYPES.iter().map(move |b| [a, b]));
    let chains = types.enumerate().map(move |(index, types)| Chain {
        types: types.to_vec(),
        roles: roles.to_vec(),
        directions: vec![direction],
        origins: vec![origin],
        has_forces: index.is_multiple_of(7),
    });
    chains.filter(Chain::is_describable)
}

fn places() -> impl Iterator<Item = (usize, Origin)> {
    (0..DIRECTIONS.len()).flat_map(|direction| Origin::ALL.map(|origin| (direction, origin)))
}

fn roles() -> impl Iterator<Item = [Role; 2]> {
    Role::ALL.into_iter().flat_map(|first| Role::ALL.map(|second| [first, second]))
}

/// Every triple of hinges, slides, balls and floating joints.
fn triples() -> Vec<Chain> {
    let types = || TYPES[6..].iter();
    let types = types().flat_map(|a| types().flat_map(move |b| types().map(move |c| [a, b, c])));
    let placed = types.flat_map(|types| {
        let last = (0..DIRECTIONS.len()).map(move |second| (types, second));
        last.flat_map(|(types, second)| places().map(move |(first, origin)| (types, [first, second], origin)))
    });
    let chains = placed.enumerate().map(|(index, (types, directions, origin))| Chain {
        types: types.to_vec(),
        roles: vec![Role::Free; 3],
        directions: directions.to_vec(),
        origins: vec![origin; 2],
        has_forces: index.is_multiple_of(7),
    });
    chains.filter(Chain::is_describable).collect()
}

/// Triples of all types by chance.
fn sampled(count: usize) -> Vec<Chain> {
    let mut rng = Rng::with_seed(39);
    let mut draw = || Chain {
        types: (0..3).map(|_| &TYPES[rng.usize(0..TYPES.len())]).collect(),
        roles: (0..3).map(|_| Role::ALL[rng.usize(0..3)]).collect(),
        directions: (0..2).map(|_| rng.usize(0..DIRECTIONS.len())).collect(),
        origins: (0..2).map(|_| Origin::ALL[rng.usize(0..3)]).collect(),
        has_forces: rng.bool(),
    };
    std::iter::repeat_with(&mut draw).filter(Chain::is_describable).take(count).collect()
}

/// The part of the chains to compare, from 1, and how many parts there are.
fn part() -> (usize, usize) {
    let Ok(text) = std::env::var("GELENK_CHAINS") else { return (1, 1) };
    let numbers =
        text.split_once('/').and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    match numbers {
        Some((part, parts)) if (1..=parts).contains(&part) => (part, parts),
        _ => panic!("GELENK_CHAINS is {text}; it must be as 3/20"),
    }
}

/// Compares functions of all chains, each in one state.
///
/// - `functions`: those of a robot, by its number
fn check(what: &str, chains: &[Chain], functions: impl Fn(&Model, usize) -> Vec<String> + Sync) {
    let (part, parts) = part();
    let numbered: Vec<(usize, &Chain)> = chains.iter().enumerate().skip(part - 1).step_by(parts).collect();
    let compared = in_parallel(&numbered, |&(number, chain)| {
        let seed = number as u64;
        let model = chain.model(seed);
        let state = State::random(&mut Rng::with_seed(seed), &model);
        assert_agreement(&chain.text(seed), &model, &state, &functions(&model, number))
    });
    let all: Vec<_> = compared.iter().flatten().collect();
    let loops = all.iter().filter(|each| each.is_loops).count();
    let worst =
        all.iter().max_by(|a, b| a.error.total_cmp(&b.error)).map(|each| (&each.function, each.error));
    println!(
        "{what}: {} robots, {} functions, {loops} of them as loops, largest error {worst:?}",
        numbered.len(),
        all.len()
    );
}

/// Each pair of types with parallel axes, where most rules for special places hold, and in one of the other directions.
#[test]
fn pairs_of_joints_agree_with_the_equations() {
    let free = |direction: usize, shift: usize| {
        let origin = move |index: usize| Origin::ALL[(index + shift) % 3];
        let placed = move |(index, chain)| Chain { origins: vec![origin(index)], ..chain };
        pairs(direction, Origin::Same, [Role::Free; 2]).enumerate().map(placed).collect::<Vec<_>>()
    };
    let parallel = free(0, 0);
    assert_eq!(parallel.len(), 99, "two joints of a robot do not float");
    check("parallel", &parallel, a_third);
    let others: Vec<Vec<Chain>> = (1..DIRECTIONS.len()).map(|direction| free(direction, 1)).collect();
    let others: Vec<Chain> = (0..parallel.len()).map(|index| others[index % 5][index].clone()).collect();
    let is_kinematic = |name: &String| is_of_frame(name) || name == "mass_matrix";
    check("others", &others, |model, _| functions(model).into_iter().filter(is_kinematic).collect());
}

/// Joints that follow others and driven ones, in each place.
#[test]
fn coupled_and_driven_pairs_agree_with_the_equations() {
    let placed = roles().skip(1).zip(places().skip(1).step_by(2));
    let pairs = placed.flat_map(|(roles, (direction, origin))| pairs(direction, origin, roles).step_by(10));
    check("coupled and driven", &pairs.collect::<Vec<_>>(), a_third);
}

#[test]
#[ignore = "takes an hour; see the head of this file"]
fn all_chains_agree_with_the_equations() {
    let pairs = roles()
        .flat_map(|roles| places().flat_map(move |(direction, origin)| pairs(direction, origin, roles)));
    let all = |model: &Model, _: usize| functions(model);
    check("pairs", &pairs.collect::<Vec<_>>(), all);
    check("triples", &triples(), all);
    check("others", &sampled(2000), all);
}
