//! Rank correlation, fractions within a factor, and how often the classification is right.

use std::fmt::Write;

use cohaul::math::{RandomStreams, Stream};

use super::scene::{Class, Found};

pub fn report(found: &[Found]) -> String {
    let mut text = String::new();
    let random = |scene: &&Found| scene.class == Class::Random;
    let certain: Vec<&Found> = found.iter().filter(|scene| scene.is_certain()).collect();
    let of = |keep: &dyn Fn(&&Found) -> bool| certain.iter().copied().filter(keep).collect::<Vec<_>>();
    line(&mut text, "| scenes | n | Spearman | 95 % interval | within 1.25 | within 2 | within 5 | median ratio |");
    line(&mut text, "|---|---|---|---|---|---|---|---|");
    row(&mut text, "random, all", &of(&random));
    row(&mut text, "random, tips", &of(&|scene| random(scene) && !scene.has_ants));
    row(&mut text, "random, ants", &of(&|scene| random(scene) && scene.has_ants));
    for kind in ["driving", "jump", "start"] {
        row(&mut text, &format!("random, largest after: {kind}"), &of(&|scene| random(scene) && scene.kind() == kind));
    }
    row(&mut text, "random, undamped", &of(&|scene| random(scene) && scene.numbers.zeta == Some(0.0)));
    row(&mut text, "random, damped", &of(&|scene| random(scene) && scene.numbers.zeta > Some(0.0)));
    row(&mut text, "stored", &of(&|scene| !random(scene)));
    let still = found.iter().filter(|scene| scene.measured == 0.0);
    let n_zero = still.clone().filter(|scene| scene.estimate.edge_displacement_max_m == 0.0).count();
    line(&mut text, &format!("\nscenes in which inertia changes nothing: {}; the estimate is zero in {n_zero} of them", still.count()));
    for scene in found.iter().filter(|scene| scene.measured > 0.0 && !scene.is_certain()) {
        let (measured, own, estimated) = (scene.measured, scene.reference_error, scene.estimate.edge_displacement_max_m);
        line(
            &mut text,
            &format!(
                "left out: {}: measured {measured:.2e} m, reference error {own:.2e} m, estimated {estimated:.2e} m, {:?}",
                scene.name, scene.status
            ),
        );
    }
    line(&mut text, "\n| threshold | both negligible | false alarm | missed | neither negligible |");
    line(&mut text, "|---|---|---|---|---|");
    for threshold in [0.001, 0.003, 0.01, 0.03, 0.1] {
        let mut counts = [0; 4];
        for scene in found.iter().filter(random) {
            let (measured, estimated) = (scene.measured_share() > threshold, scene.estimate.share > threshold);
            counts[usize::from(measured) * 2
                + usize::from(measured == estimated) * usize::from(measured)
                + usize::from(!measured && estimated)] += 1;
        }
        line(&mut text, &format!("| {} % | {} | {} | {} | {} |", 100.0 * threshold, counts[0], counts[1], counts[2], counts[3]));
    }
    line(&mut text, "\nlargest misses:");
    let mut worst = certain.clone();
    worst.sort_by(|a, b| b.ratio().ln().abs().total_cmp(&a.ratio().ln().abs()));
    for scene in worst.iter().take(12) {
        let (epsilon, phi) = (scene.numbers.epsilon.unwrap_or(0.0), scene.numbers.phi.unwrap_or(0.0));
        let what = format!(
            "epsilon {epsilon:.3}, Phi {phi:.1}, zeta {:.2}, {} releases",
            scene.numbers.zeta.unwrap_or_default(),
            scene.n_releases
        );
        line(
            &mut text,
            &format!(
                "- {}: {:.2} times {:.2e} m of {:.2e} m ({}; {what})",
                scene.name,
                scene.ratio(),
                scene.measured,
                scene.path_length,
                scene.kind()
            ),
        );
    }
    text
}

fn line(text: &mut String, line: &str) {
    writeln!(text, "{line}").expect("a string takes all");
}

fn row(text: &mut String, name: &str, scenes: &[&Found]) {
    if scenes.len() < 3 {
        return;
    }
    let pairs: Vec<(f64, f64)> = scenes.iter().map(|scene| (scene.estimate.edge_displacement_max_m, scene.measured)).collect();
    let within = |factor: f64| {
        let n = scenes.iter().filter(|scene| (1.0 / factor..=factor).contains(&scene.ratio())).count();
        format!("{:.0} %", 100.0 * n as f64 / scenes.len() as f64)
    };
    let mut ratios: Vec<f64> = scenes.iter().map(|scene| scene.ratio()).collect();
    ratios.sort_by(f64::total_cmp);
    let (low, high) = bootstrap(&pairs);
    let cells = format!("{} | {} | {} | {:.2}", within(1.25), within(2.0), within(5.0), ratios[ratios.len() / 2]);
    line(text, &format!("| {name} | {} | {:.3} | {low:.3} to {high:.3} | {cells} |", scenes.len(), spearman(&pairs)));
}

/// Rank correlation after Spearman (1904), with mean ranks for equal values.
fn spearman(pairs: &[(f64, f64)]) -> f64 {
    let (a, b) = (ranks(pairs.iter().map(|pair| pair.0).collect()), ranks(pairs.iter().map(|pair| pair.1).collect()));
    let mean = 0.5 * (pairs.len() as f64 - 1.0);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

fn ranks(values: Vec<f64>) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    while first < order.len() {
        let n_equal = order[first..].iter().take_while(|index| values[**index] == values[order[first]]).count();
        order[first..first + n_equal].iter().for_each(|index| ranks[*index] = first as f64 + 0.5 * (n_equal as f64 - 1.0));
        first += n_equal;
    }
    ranks
}

/// Percentile interval of the bootstrap over scenes.
fn bootstrap(pairs: &[(f64, f64)]) -> (f64, f64) {
    const N: u32 = 2000;
    let streams = RandomStreams::new(1);
    let draw = |round: u32| {
        let pick = |at: usize| pairs[(streams.uniform(Stream::Scene, round, at as u64) * pairs.len() as f64) as usize];
        spearman(&(0..pairs.len()).map(pick).collect::<Vec<_>>())
    };
    let mut drawn: Vec<f64> = (0..N).map(draw).collect();
    drawn.sort_by(f64::total_cmp);
    (drawn[(N / 40) as usize], drawn[(N - N / 40) as usize])
}
