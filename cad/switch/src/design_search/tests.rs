//! Complete searches for small requests.

use super::*;
use crate::request::{Parameter, Target, Varied, Vary};

fn base() -> Design {
    Design::new(Configuration::default()).unwrap()
}

fn request(targets: Vec<(Quantity, Requirement)>) -> Request {
    let targets =
        targets.into_iter().map(|(quantity, requirement)| Target { quantity, requirement }).collect();
    Request { targets, ..Request::default() }
}

fn few(best: usize) -> Options {
    Options { best, draws: 100, starts: 3, ..Options::default() }
}

fn found(request: &Request, options: Options) -> Found {
    search(&base(), request, &PublishedPhysics::default(), options, &Silent)
}

#[test]
fn proposals_meet_the_request_and_differ() {
    let mut request = request(vec![
        (Quantity::Threshold, Requirement::About { value: 24.0, within: 0.1 }),
        (Quantity::MaxFriction, Requirement::AtMost(9.0)),
    ]);
    request.limits.pins = Some((2, 4));
    let found = found(&request, few(5));
    assert!(found.blocked.is_none() && found.proposals.len() >= 3, "{}", found.proposals.len());
    for (i, p) in found.proposals.iter().enumerate() {
        assert!(p.targets.iter().all(|t| t.is_met), "{p:?}");
        assert!((2..=4).contains(&p.pins.len()));
        let others = &found.proposals[..i];
        assert!(others.iter().all(|o| differ_in_kind(&o.configuration, &p.configuration)));
        assert!(others.iter().all(|o| o.probability.all >= p.probability.all));
        assert!(Design::new(p.configuration.clone()).is_ok());
        let shares: f64 = p.uncertainty.iter().map(|s| s.share).sum();
        assert!((shares - 1.0).abs() < 1e-9);
        assert_eq!(p.sensitivity.len(), Parameter::ALL.len());
    }
}

#[test]
fn equal_requests_give_equal_proposals() {
    let mut request = request(vec![(Quantity::MaxFriction, Requirement::AtMost(8.0))]);
    request.limits.pins = Some((2, 3));
    let fewer = Options { starts: 1, draws: 50, ..few(2) };
    let twice = [found(&request, fewer), found(&request, fewer)].map(|f| format!("{:?}", f.proposals));
    assert_eq!(twice[0], twice[1]);
}

#[test]
fn a_fixed_part_is_evaluated_unchanged() {
    let mut request = request(vec![(Quantity::Threshold, Requirement::AtLeast(5.0))]);
    request.vary = Vary { pattern: false, parameters: Vec::new() };
    let mut configuration = Configuration::default();
    configuration.layout.pins = vec![5, 8, 11];
    let base = Design::new(configuration).unwrap();
    let found = search(&base, &request, &PublishedPhysics::default(), few(5), &Silent);
    assert_eq!((found.patterns, found.proposals.len()), (1, 1));
    assert_eq!(found.proposals[0].pins, [5, 8, 11]);
}

#[test]
fn an_impossible_request_reports_its_limit() {
    // A high threshold needs a thin layer or hard silicone, and the thickness can hardly vary.
    let mut request = request(vec![(Quantity::Threshold, Requirement::Between(34.0, 40.0))]);
    request.limits.pins = Some((3, 3));
    request.vary.parameters = vec![Varied { parameter: Parameter::LayerMm, from: 1.9, to: 2.1 }];
    let found = found(&request, few(5));
    let blocked = found.blocked.unwrap();
    assert_eq!(found.proposals.len(), 1);
    assert_eq!(blocked.missed.len(), 1);
    assert!(blocked.missed[0].value < 34.0);
    let first = &blocked.moves[0];
    assert!(first.meets, "{blocked:?}");
    // The advice is correct: the change alone meets the request.
    let mut moved = found.proposals[0].configuration.clone();
    first.parameter.set(&mut moved, first.to);
    request.vary = Vary { pattern: false, parameters: Vec::new() };
    let base = Design::new(moved).unwrap();
    let again = search(&base, &request, &PublishedPhysics::default(), few(1), &Silent);
    assert!(again.blocked.is_none());
}

#[test]
fn probabilities_agree_across_seeds() {
    let mut request = request(vec![(Quantity::MaxFriction, Requirement::Between(6.0, 9.0))]);
    request.limits.pins = Some((3, 4));
    let options = Options { draws: 500, ..few(1) };
    for p in found(&request, options).proposals {
        let design = Design::new(p.configuration.clone()).unwrap();
        let again = simulated(&design, &request, &PublishedPhysics::default(), 500, 77).unwrap();
        assert!((again.all - p.probability.all).abs() < 0.07, "{} {}", again.all, p.probability.all);
    }
}
