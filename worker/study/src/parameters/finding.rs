//! What can be said of a result from the numbers alone.
use loadframe_physics::Welch;
use serde::Serialize;

use super::case::CaseRow;
use super::labels::Labels;
use crate::text::{probability, sentence};

/// Differences that samples of equal populations show more often than this are called chance.
const LEVEL: f64 = 0.05;

/// How a result differs between cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    pub unit: String,
    /// Over the cases as they are listed.
    pub trend: Trend,
    /// Labels of the cases that know the result, from the smallest mean to the largest.
    pub order: Vec<String>,
    /// Between neighbours of that order.
    pub steps: Vec<Step>,
    /// Between its ends.
    pub ends: Option<Step>,
    /// The same as sentences.
    pub words: String,
}

/// From one case to the next of the order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    pub from: String,
    pub to: String,
    /// Of the means.
    pub difference: f64,
    /// Probability of a difference this large between samples of equal populations, by Welch's t.
    /// The test takes the samples as independent: where a seed gives alike specimens in both cases,
    /// a difference may be real though p is large. `null` where a case has less than two values, and
    /// where seeds change nothing in either: without scatter there is no chance to test against.
    pub p: Option<f64>,
    /// Whether all values over the seeds are equal in both cases.
    #[serde(skip)]
    is_without_scatter: bool,
}

/// Which way a result goes over the cases as they are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Trend {
    /// From each case to the next.
    Rises,
    /// From each case to the next.
    Falls,
    Neither,
    /// Exactly equal in all cases.
    Same,
    /// Fewer than two cases know the result.
    Unknown,
}

impl Finding {
    pub(super) fn of(name: &str, cases: &[CaseRow]) -> Self {
        let mean = |case: &&CaseRow| case.results[name].mean;
        let known: Vec<&CaseRow> = cases.iter().filter(|case| mean(case).is_some()).collect();
        let mut order = known.clone();
        // a stable order: equal means stay as they are listed
        order.sort_by(|a, b| mean(a).unwrap_or(0.0).total_cmp(&mean(b).unwrap_or(0.0)));
        let steps = order
            .windows(2)
            .filter_map(|pair| Step::between(name, pair[0], pair[1]));
        let ends = match order.as_slice() {
            [first, _, .., last] => Step::between(name, first, last),
            _ => None,
        };
        let mut finding = Self {
            unit: known
                .first()
                .map_or_else(String::new, |case| case.results[name].unit.clone()),
            trend: trend(&known.iter().filter_map(mean).collect::<Vec<f64>>()),
            order: order.iter().map(|case| case.label.clone()).collect(),
            steps: steps.collect(),
            ends,
            words: String::new(),
        };
        let listed = match finding.trend {
            Trend::Rises | Trend::Falls => &known,
            _ => &order,
        };
        finding.words = finding.sentences(name, listed, Labels::of(cases));
        finding
    }

    /// `cases`: in the order in which they are told.
    fn sentences(&self, name: &str, cases: &[&CaseRow], labels: Labels<'_>) -> String {
        let unit = match self.unit.as_str() {
            "1" | "" => String::new(),
            unit => format!(" {unit}"),
        };
        let told = |case: &&CaseRow| {
            let mean = case.results[name].mean_in_words();
            format!("{} ({mean}{unit})", labels.short(&case.label))
        };
        let told: Vec<String> = cases.iter().map(told).collect();
        let (name, all) = (sentence(name), told.join(", "));
        match self.trend {
            Trend::Unknown if cases.is_empty() => format!("{name} is known in no case."),
            Trend::Unknown => format!("{name} is known in one case only: {all}."),
            Trend::Same => format!("{name} is exactly the same in all cases."),
            Trend::Rises => format!(
                "{name} rises from case to case: {all}. {}",
                self.chance(labels)
            ),
            Trend::Falls => format!(
                "{name} falls from case to case: {all}. {}",
                self.chance(labels)
            ),
            Trend::Neither => format!(
                "{name} neither rises nor falls throughout; from the smallest: {all}. {}",
                self.chance(labels)
            ),
        }
    }

    /// Which differences may be chance.
    fn chance(&self, labels: Labels<'_>) -> String {
        let tested = self.steps.iter().filter_map(|step| Some((step, step.p?)));
        let tested: Vec<(&Step, f64)> = tested.collect();
        let pair = |step: &Step| {
            let [from, to] = [&step.from, &step.to].map(|label| labels.short(label));
            format!("{from} and {to}")
        };
        let equal = self.steps.iter().filter(|step| step.is_without_scatter);
        let equal: Vec<String> = equal.map(pair).collect();
        if tested.len() + equal.len() < self.steps.len() {
            return "With less than two specimens in a case nothing can be said of chance."
                .to_owned();
        }
        if tested.is_empty() {
            return "Seeds change nothing in it, so that nothing is said of chance.".to_owned();
        }
        if equal.is_empty() {
            return self.tested(&tested, ["The difference", "neighbours"], labels);
        }
        // what is said of the others must not pass for all
        let one = format!("The difference between {}", pair(tested[0].0));
        format!(
            "Seeds change nothing in {}, so that nothing is said of chance there. {}",
            equal.join("; "),
            self.tested(&tested, [&one, "other neighbours"], labels)
        )
    }

    /// Which of the differences that were tested may be chance; `names`: of one of them, and of the
    /// cases between which they are.
    fn tested(&self, tested: &[(&Step, f64)], names: [&str; 2], labels: Labels<'_>) -> String {
        let [one, all] = names;
        let test = format!("Welch's t, {} %", 100.0 * LEVEL);
        let smallest = tested.iter().map(|(_, p)| *p).fold(1.0, f64::min);
        let largest = tested.iter().map(|(_, p)| *p).fold(0.0, f64::max);
        if let [(_, p)] = tested[..] {
            let than = if p > LEVEL { "may be" } else { "is more than" };
            return format!("{one} {than} chance ({test}; {}).", probability(p));
        }
        if largest <= LEVEL {
            let most = probability(largest);
            return format!("All {all} differ by more than chance ({test}; at most {most}).");
        }
        let neighbours = if smallest > LEVEL {
            let least = probability(smallest);
            format!("Between {all} all differences may be chance ({test}; at least {least})")
        } else {
            let alike = tested.iter().filter(|(_, p)| *p > LEVEL).map(|(step, p)| {
                let [from, to] = [&step.from, &step.to].map(|label| labels.short(label));
                format!("{from} and {to} ({})", probability(*p))
            });
            let alike: Vec<String> = alike.collect();
            format!(
                "Between these the difference may be chance ({test}): {}",
                alike.join("; ")
            )
        };
        match self.ends.as_ref().and_then(|ends| ends.p) {
            Some(p) if p > LEVEL => {
                format!(
                    "{neighbours}; between the smallest and the largest too ({}).",
                    probability(p)
                )
            }
            Some(p) => {
                format!(
                    "{neighbours}; the smallest and the largest do differ ({}).",
                    probability(p)
                )
            }
            None => format!("{neighbours}."),
        }
    }
}

impl Step {
    fn between(name: &str, from: &CaseRow, to: &CaseRow) -> Option<Self> {
        let [first, second] = [from, to].map(|case| case.results[name].sample());
        let (first, second) = (first?, second?);
        let is_without_scatter = [&first, &second].map(|s| s.deviation) == [Some(0.0); 2];
        let test = Welch::test(&first, &second).filter(|_| !is_without_scatter);
        Some(Self {
            from: from.label.clone(),
            to: to.label.clone(),
            difference: second.mean - first.mean,
            p: test.map(|test| test.p),
            is_without_scatter,
        })
    }
}

#[allow(
    clippy::float_cmp,
    reason = "what no parameter touches is exactly the same"
)]
fn trend(means: &[f64]) -> Trend {
    let all = |holds: fn(f64, f64) -> bool| means.windows(2).all(|pair| holds(pair[0], pair[1]));
    match means {
        [] | [_] => Trend::Unknown,
        _ if all(|a, b| a == b) => Trend::Same,
        _ if all(|a, b| a < b) => Trend::Rises,
        _ if all(|a, b| a > b) => Trend::Falls,
        _ => Trend::Neither,
    }
}
