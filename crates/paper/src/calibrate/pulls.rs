//! Comparison of two samples of pulls, each from several runs.
//!
//! Pulls of one run depend on each other: an ant that pulls strongly now does so in the next frame,
//! and the pose of the load acts on all pulls for many seconds. A test that takes each pull as
//! independent therefore finds differences where there are none. Here whole blocks of time are
//! exchanged between the two samples. If both have the same distribution, all assignments of blocks
//! to samples are equally probable, and the share of them with at least the distance that was found
//! is the p-value.

use serde::Serialize;

use cohaul::formats::{self, Format, Versioned};
use cohaul::math::{RandomStreams, Stream, Summary};
use cohaul::scenario::ScenarioError;
use cohaul_report::quantity::short_quantity;
use cohaul_studies::csv_input::Table;

/// Pulls of one recording over time, in the order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PullSeries {
    /// Times (s) and pulls (N).
    pub pulls: Vec<(f64, f64)>,
}

/// Two samples of pulls and the distance of their distributions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PullComparison {
    pub samples: [PullSample; 2],
    /// Cramer-von Mises distance: the mean square of the difference between both distribution
    /// functions, over all pulls (1).
    pub distance: f64,
    /// Probability of a distance as large, if both had the same distribution and blocks were
    /// independent.
    pub p_value: f64,
    pub n_permutations: u32,
    /// Correlation of the mean pulls of neighbouring blocks; `null` below eight pairs. Far from
    /// zero, blocks are too short to be independent.
    pub block_correlation: Option<f64>,
}

impl Versioned for PullComparison {
    const FORMAT: Format = formats::CALIBRATE_PULLS;
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PullSample {
    pub n_pulls: u64,
    pub n_blocks: usize,
    pub mean_n: f64,
    pub sd_n: f64,
    pub max_n: f64,
}

impl PullSeries {
    /// Reads the columns `time_s` and `force_n` of a table, such as that of `calibrate forces`.
    ///
    /// # Errors
    /// When a column is missing, or a field is not a number.
    pub fn parse(text: &str, file: &str) -> Result<Self, ScenarioError> {
        let mut table = Table::parse(text, file, &[])?;
        table.require(&["time_s", "force_n"]);
        let mut table = table.whole()?;
        let mut pulls = Vec::with_capacity(table.n_rows());
        for row in 0..table.n_rows() {
            let (time, pull) = (table.number(row, "time_s"), table.number(row, "force_n"));
            if pull.is_some_and(|pull| pull < 0.0) {
                table.at(row, "force_n", "must not be negative", pull.unwrap_or_default());
            }
            pulls.extend(time.zip(pull));
        }
        if table.n_rows() == 0 {
            table.report("rows", "must hold pulls", "none");
        }
        table.whole()?;
        pulls.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Self { pulls })
    }

    /// Time from the first pull to the last (s).
    pub fn duration(&self) -> f64 {
        self.pulls.first().zip(self.pulls.last()).map_or(0.0, |(first, last)| last.0 - first.0)
    }

    /// Blocks of about this duration (s), all of the same; `None` stands for the whole series.
    ///
    /// # Errors
    /// When there would be more than 10,000 blocks: the error says which duration is long enough.
    pub fn blocks(&self, duration: Option<f64>) -> Result<Vec<Vec<f64>>, String> {
        let (Some(first), Some(last)) = (self.pulls.first(), self.pulls.last()) else { return Ok(Vec::new()) };
        let whole = last.0 - first.0;
        let n = duration.map_or(1.0, |duration| (whole / duration).round().max(1.0));
        if n > MOST_BLOCKS {
            let (least, found) = (short_quantity(whole / MOST_BLOCKS, "s"), short_quantity(duration.unwrap_or_default(), "s"));
            return Err(format!(
                "must make at most {MOST_BLOCKS} blocks of a table: from the first time, {} s, to the last, {} s, a block must be at \
                 least {least}, found {found}",
                first.0, last.0
            ));
        }
        let mut blocks = vec![Vec::new(); n as usize];
        for (time, pull) in &self.pulls {
            let share = if whole > 0.0 { (time - first.0) / whole } else { 0.0 };
            blocks[((n * share) as usize).min(n as usize - 1)].push(*pull);
        }
        blocks.retain(|block| !block.is_empty());
        Ok(blocks)
    }
}

/// Largest number of blocks of one table (1). Each takes 4 kB while samples are compared.
const MOST_BLOCKS: f64 = 1e4;

/// Number of blocks into which each table is cut where whole tables are too few for a test (1): two
/// tables then have 184,756 assignments of their blocks.
const BLOCKS_OF_A_TABLE: f64 = 10.0;

/// Duration of a block (s) for a test of these series, which are whole blocks themselves if there
/// are enough of them: then `None`.
pub fn block_duration(samples: [&[PullSeries]; 2]) -> Option<f64> {
    let shortest = samples.iter().flat_map(|series| series.iter()).map(PullSeries::duration).fold(f64::INFINITY, f64::min);
    let are_too_few = assignments(samples[0].len(), samples[1].len()) < LEAST_ASSIGNMENTS;
    (are_too_few && shortest > 0.0).then_some(shortest / BLOCKS_OF_A_TABLE)
}

/// Number of pulls at which distribution functions are compared, equally spaced in rank.
const N_PLACES: usize = 512;
/// Least number of assignments of blocks to samples: with fewer, no distance would be significant.
const LEAST_ASSIGNMENTS: f64 = 100.0;

/// Compares two samples of blocks.
///
/// # Errors
/// When there are too few blocks for a test.
pub fn compare_pulls(samples: [&[Vec<Vec<f64>>]; 2], n_permutations: u32, seed: u64) -> Result<PullComparison, String> {
    let blocks: Vec<&Vec<f64>> = samples.iter().flat_map(|series| series.iter().flatten()).collect();
    let [n_one, n_other] = samples.map(|series| series.iter().map(Vec::len).sum::<usize>());
    if assignments(n_one, n_other) < LEAST_ASSIGNMENTS {
        return Err(format!(
            "must have enough blocks that at least {LEAST_ASSIGNMENTS} assignments exist (more files, or a shorter --block-s), \
             found {n_one} and {n_other}"
        ));
    }
    let counts = Counts::of(&blocks);
    let distance = counts.distance(0..n_one);
    let streams = RandomStreams::new(seed);
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    let mut n_as_far = 0;
    for permutation in 0..n_permutations {
        for i in 0..n_one {
            let drawn = streams.uniform(Stream::Resample, permutation, i as u64);
            order.swap(i, i + (drawn * (blocks.len() - i) as f64) as usize);
        }
        // The margin is for sums in another order.
        n_as_far += u32::from(counts.distance(order[..n_one].iter().copied()) >= distance * (1.0 - 1e-12));
    }
    let sample = |series: &[Vec<Vec<f64>>], n_blocks: usize| {
        let pulls = Summary::of(series.iter().flatten().flatten().copied());
        PullSample { n_pulls: pulls.n(), n_blocks, mean_n: pulls.mean(), sd_n: pulls.sd(), max_n: pulls.max() }
    };
    Ok(PullComparison {
        samples: [sample(samples[0], n_one), sample(samples[1], n_other)],
        distance,
        p_value: f64::from(n_as_far + 1) / f64::from(n_permutations + 1),
        n_permutations,
        block_correlation: block_correlation(&samples),
    })
}

/// Number of ways to choose so many blocks of all.
fn assignments(n_one: usize, n_other: usize) -> f64 {
    (1..=n_one).map(|k| (n_other + k) as f64 / k as f64).product()
}

/// For each block, the number of its pulls up to each place.
struct Counts {
    blocks: Vec<Vec<f64>>,
    total: Vec<f64>,
}

impl Counts {
    fn of(blocks: &[&Vec<f64>]) -> Self {
        let mut all: Vec<f64> = blocks.iter().flat_map(|block| block.iter().copied()).collect();
        all.sort_by(f64::total_cmp);
        let n_places = N_PLACES.min(all.len());
        let places: Vec<f64> = (1..=n_places).map(|k| all[k * all.len() / n_places - 1]).collect();
        let counts = |block: &&Vec<f64>| {
            let mut sorted = (*block).clone();
            sorted.sort_by(f64::total_cmp);
            places.iter().map(|place| sorted.partition_point(|pull| pull <= place) as f64).collect()
        };
        let blocks: Vec<Vec<f64>> = blocks.iter().map(counts).collect();
        let total = (0..n_places).map(|at| blocks.iter().map(|block| block[at]).sum()).collect();
        Self { blocks, total }
    }

    /// Mean square difference between the distribution functions of these blocks and of the others.
    fn distance(&self, one: impl Iterator<Item = usize>) -> f64 {
        let mut sums = vec![0.0; self.total.len()];
        for block in one {
            sums.iter_mut().zip(&self.blocks[block]).for_each(|(sum, count)| *sum += count);
        }
        // The last place is the largest pull.
        let (n_one, n) = (sums[sums.len() - 1], self.total[self.total.len() - 1]);
        let square = |(sum, total): (&f64, &f64)| (sum / n_one - (total - sum) / (n - n_one)).powi(2);
        sums.iter().zip(&self.total).map(square).sum::<f64>() / sums.len() as f64
    }
}

/// Correlation between the mean pulls of neighbouring blocks of a series, about the mean of their
/// sample.
fn block_correlation(samples: &[&[Vec<Vec<f64>>]; 2]) -> Option<f64> {
    let (mut n, mut products, mut squares) = (0, 0.0, 0.0);
    for sample in samples {
        let mean = |block: &Vec<f64>| block.iter().sum::<f64>() / block.len() as f64;
        let means: Vec<Vec<f64>> = sample.iter().map(|series| series.iter().map(mean).collect()).collect();
        let middle = Summary::of(means.iter().flatten().copied()).mean();
        for pair in means.iter().flat_map(|series| series.windows(2)) {
            let [one, next] = [pair[0] - middle, pair[1] - middle];
            n += 1;
            products += one * next;
            squares += 0.5 * (one * one + next * next);
        }
    }
    (n >= 8 && squares > 0.0).then(|| products / squares)
}
