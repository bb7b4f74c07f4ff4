//! `cohaul scenario new`.

use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};

use super::choice::{not_negative, positive};
use super::console::{self, print};
use super::error::{CliError, at_output};
use super::input::warn_of_scenario;
use cohaul::scenario::format::{self, ScenarioFile};
use cohaul_report::json;
use cohaul_report::sibling::write_whole;
use cohaul_studies::first_scene::{FirstScene, MOST_ROBOTS, Shape, Size, text_of};

#[derive(Args)]
#[command(after_help = "\
Examples:
  cohaul scenario new first.json
  cohaul scenario new tow.json --robots 3 --outline box --size 0.4x0.3 --mass 2")]
pub struct NewArgs {
    /// File to write; - for standard output
    file: PathBuf,
    /// Number of robots, each on a spring of its own [default: 3]
    #[arg(long, value_name = "N", value_parser = robots)]
    robots: Option<usize>,
    /// Outline of the load [default: box]
    #[arg(long, value_enum)]
    outline: Option<OutlineKind>,
    /// Length and width of a box, or diameter of a disc (m) [default: 0.4x0.3, or 0.4]
    #[arg(long, value_name = "M")]
    size: Option<Size>,
    /// Mass of the load (kg) [default: 2]
    #[arg(long, value_name = "KG", value_parser = positive)]
    mass: Option<f64>,
    /// Coefficient of friction with the ground (1) [default: 0.5]
    #[arg(long, value_name = "MU", value_parser = not_negative)]
    friction: Option<f64>,
    /// Speed of the robots (m/s) [default: 0.1]
    #[arg(long, value_name = "V", value_parser = positive)]
    speed: Option<f64>,
    /// Name of the scene [default: what is towed by whom]
    #[arg(long)]
    name: Option<String>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OutlineKind {
    /// A rectangle about its centre
    Box,
    /// A disc about its centre
    Disc,
}

/// Name of the schema beside a new scene.
const SCHEMA: &str = "scenario.schema.json";

/// Length (m) and mass (kg) of a load above which a warning asks about units.
const LONGEST: f64 = 20.0;
const HEAVIEST: f64 = 1000.0;

pub fn new(args: &NewArgs) -> Result<ExitCode, CliError> {
    let is_printed = args.file.as_os_str() == "-";
    if !is_printed {
        check_file(&args.file, args.force)?;
    }
    let scene = if io::stdin().is_terminal() && io::stderr().is_terminal() {
        asked(args, &mut Questions { answers: io::stdin().lock(), questions: io::stderr().lock(), asks: true })?
    } else {
        asked(args, &mut Questions { answers: io::empty(), questions: io::sink(), asks: false })?
    };
    warn_of_units(&scene);
    if is_printed {
        let file = ScenarioFile { schema: None, ..scene.file(SCHEMA) };
        let scenario = file.clone().checked("standard output")?;
        print(&text_of(&file)?)?;
        warn_of_scenario(&args.file, &scenario);
        return Ok(ExitCode::SUCCESS);
    }
    let file = scene.file(SCHEMA);
    let name = args.file.display().to_string();
    let scenario = file.clone().checked(&name)?;
    write(&args.file, &text_of(&file)?, args.force)?;
    let schema = args.file.with_file_name(SCHEMA);
    if !schema.exists() {
        write(&schema, &json::pretty(format::schema())?, false)?;
    }
    let (load, next) = (in_words(&scene), format!("next: cohaul scenario check {name}, cohaul compare {name}"));
    print(&format!("{name}: \"{}\"\n{load}\n{next}\n", scenario.name))?;
    warn_of_scenario(&args.file, &scenario);
    Ok(ExitCode::SUCCESS)
}

/// The load with its units.
fn in_words(scene: &FirstScene) -> String {
    let outline = match scene.shape {
        Shape::Box([length, width]) => format!("a box of {length} m x {width} m"),
        Shape::Disc(diameter) => format!("a disc of {diameter} m diameter"),
    };
    let (mass, speed) = (scene.mass, scene.speed);
    format!("load: {outline} and {mass} kg, friction {}; robots at {speed} m/s", scene.friction)
}

/// Warns of a load so large that its size may be in millimetres, or its mass in grams.
fn warn_of_units(scene: &FirstScene) {
    let longest = match scene.shape {
        Shape::Box([length, width]) => length.max(width),
        Shape::Disc(diameter) => diameter,
    };
    if longest > LONGEST {
        let milli = longest / 1000.0;
        console::warn(format_args!("--size: is in metres, found {longest} m; {longest} mm are {milli} m"));
    }
    if scene.mass > HEAVIEST {
        let (mass, milli) = (scene.mass, scene.mass / 1000.0);
        console::warn(format_args!("--mass: is in kilograms, found {mass} kg; {mass} g are {milli} kg"));
    }
}

fn check_file(path: &Path, force: bool) -> Result<(), CliError> {
    if path.is_dir() {
        return Err(CliError::Usage(format!("{}: must be a file, found a folder", path.display())));
    }
    if path.exists() && !force {
        return Err(CliError::Usage(format!("{}: already exists; --force replaces it", path.display())));
    }
    Ok(())
}

fn write(path: &Path, text: &str, force: bool) -> Result<(), CliError> {
    check_file(path, force)?;
    write_whole(path, |out| out.write_all(text.as_bytes())).map_err(at_output(path))
}

/// The scene of these options. The missing ones are asked for, or have their defaults.
fn asked(args: &NewArgs, questions: &mut Questions<impl BufRead, impl Write>) -> Result<FirstScene, CliError> {
    let n_robots = questions.answer("Number of robots", args.robots, "3", robots)?;
    let outline = |text: &str| OutlineKind::from_str(text, true).map_err(|_| format!("must be box or disc, found {text}"));
    let outline = questions.answer("Outline of the load, box or disc", args.outline, "box", outline)?;
    let (text, usual) = match outline {
        OutlineKind::Box => ("Length and width (m)", "0.4x0.3"),
        OutlineKind::Disc => ("Diameter (m)", "0.4"),
    };
    let size = questions.answer(text, args.size, usual, |text| text.parse().and_then(|size| shape(outline, size).map(|_| size)))?;
    Ok(FirstScene {
        name: args.name.clone(),
        n_robots,
        shape: shape(outline, size).map_err(|rule| CliError::Usage(format!("--size: {rule}")))?,
        mass: questions.answer("Mass of the load (kg)", args.mass, "2", positive)?,
        friction: questions.answer("Coefficient of friction with the ground", args.friction, "0.5", not_negative)?,
        speed: questions.answer("Speed of the robots (m/s)", args.speed, "0.1", positive)?,
    })
}

fn shape(outline: OutlineKind, size: Size) -> Result<Shape, String> {
    match (outline, size.width) {
        (OutlineKind::Box, width) => Ok(Shape::Box([size.length, width.unwrap_or(size.length)])),
        (OutlineKind::Disc, None) => Ok(Shape::Disc(size.length)),
        (OutlineKind::Disc, Some(_)) => Err("must be one length for a disc, its diameter, found two".to_owned()),
    }
}

fn robots(text: &str) -> Result<usize, String> {
    let found = text.parse().ok().filter(|n| (1..=MOST_ROBOTS).contains(n));
    found.ok_or_else(|| format!("must be a whole number from 1 to {MOST_ROBOTS}, found {text}"))
}

/// Questions to a person, who may take the default of each.
struct Questions<R, W> {
    answers: R,
    questions: W,
    /// Whether there is someone to answer.
    asks: bool,
}

impl<R: BufRead, W: Write> Questions<R, W> {
    /// The value of an option, or else of the answer to this question; an empty answer is `usual`.
    /// A wrong answer is asked for again.
    fn answer<T>(&mut self, text: &str, given: Option<T>, usual: &str, parse: impl Fn(&str) -> Result<T, String>) -> Result<T, CliError> {
        if let Some(value) = given {
            return Ok(value);
        }
        loop {
            let mut answer = String::new();
            if self.asks {
                write!(self.questions, "{text} [{usual}]: ")?;
                self.questions.flush()?;
                if self.answers.read_line(&mut answer)? == 0 {
                    return Err(CliError::Interrupted);
                }
            }
            let answer = if answer.trim().is_empty() { usual } else { answer.trim() };
            match parse(answer) {
                Ok(value) => return Ok(value),
                Err(rule) => console::error(rule),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(clap::Parser)]
    struct Line {
        #[command(flatten)]
        args: NewArgs,
    }

    fn scene(line: &str, answers: &str) -> (Result<FirstScene, CliError>, String) {
        let args = <Line as clap::Parser>::try_parse_from(["new", "x.json"].into_iter().chain(line.split_whitespace())).unwrap().args;
        let mut questions = Questions { answers: answers.as_bytes(), questions: Vec::new(), asks: true };
        let found = asked(&args, &mut questions);
        (found, String::from_utf8(questions.questions).unwrap())
    }

    #[test]
    fn what_is_missing_is_asked_for_and_wrong_answers_are_asked_again() {
        let (found, said) = scene("--mass 5 --speed 0.2", "0\n2\ndisc\n0.3x0.2\n0.3\n\n");
        let expected = FirstScene { name: None, n_robots: 2, shape: Shape::Disc(0.3), mass: 5.0, friction: 0.5, speed: 0.2 };
        assert_eq!(found.unwrap(), expected);
        assert_eq!(said.matches("Number of robots [3]: ").count(), 2, "{said}");
        assert_eq!(said.matches("Diameter (m) [0.4]: ").count(), 2, "{said}");
        assert!(!said.contains("Mass") && said.contains("Coefficient of friction"), "{said}");
        let all = "--robots 1 --outline box --size 0.4 --mass 1 --friction 0 --speed 1";
        let (found, said) = scene(all, "");
        assert_eq!((found.unwrap().shape, said.as_str()), (Shape::Box([0.4, 0.4]), ""));
    }

    #[test]
    fn no_answer_ends_the_questions() {
        assert!(matches!(scene("", "2\n").0, Err(CliError::Interrupted)));
    }
}
