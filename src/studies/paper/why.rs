//! Why a number of ours is where it is beside the printed one: a sentence a row.

use super::maximum::Extreme;
use super::measures::Measure;
use super::sampling::Sampling;
use crate::output::quantity::quantity;

/// What makes the difference, or the agreement, of one quantity.
pub fn why(measure: Measure) -> &'static str {
    match measure {
        Measure::PULL_MEAN | Measure::PULL_SD => {
            "fixed by what a spring gains between two decisions, which the paper leaves open and the parameter search sets; which trials it sampled is inferred from the sample's size"
        }
        Measure::PullMean(_, Sampling::ByTime) | Measure::PullSd(_, Sampling::ByTime) => {
            "a large pull ends within a few decisions but lasts for many control periods; the paper does not say when pulls were taken"
        }
        Measure::PullMean(_, Sampling::WithoutZeros) | Measure::PullSd(_, Sampling::WithoutZeros) => {
            "the same pulls without the zero at which each attachment begins"
        }
        Measure::PullMean(..) | Measure::PullSd(..) => {
            "not printed by trial: a load that follows its ants slackens their springs, one that sticks does not"
        }
        Measure::SizeShare(_) => {
            "set by how soon an ant that has let go finds a free tip, so by the reach; ours spread wider than a binomial, as ants come back unequally fast"
        }
        Measure::MixtureShare(_) => {
            "the weights of the trials are those that bring all printed counts closest; the paper does not print how many runs each trial had"
        }
        Measure::Phase(..) => "the paper shows one run; chance makes 2.5 % of runs significant, and 5 % of the change of all three",
        Measure::TimeToNest(_) => "not printed beyond an order of 100 s; goes with the inferred walking speed of pulling ants",
        Measure::Arrived(_) => "within the longest time of the scenario; not printed",
        _ => "a ratio that no inferred speed changes much",
    }
}

/// The same of the largest pull.
pub fn why_maximum(found: &Extreme) -> String {
    format!(
        "one draw of an extreme: the interval is that of a sample of the printed size, foreseen from {} pulls, whose largest was {}",
        found.n,
        quantity(found.met, "N")
    )
}
