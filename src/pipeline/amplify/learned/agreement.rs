//! Options that are said beside a file that has them already.

use super::super::exemplar;
use super::super::mode::Mode;
use super::Learned;
use crate::error::{Error, Result};
use std::path::Path;

/// An option of the command line and its value; none where it has none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// The option, such as `--factor`.
    pub option: &'static str,
    /// What was said.
    pub value: Option<String>,
}

impl Said {
    fn words(&self) -> String {
        match &self.value {
            Some(value) => format!("{} {value}", self.option),
            None => self.option.to_string(),
        }
    }
}

impl Learned {
    /// The options that it was learned with; nothing as the value of one that it was learned without.
    fn options(&self) -> Vec<(&'static str, Option<Said>)> {
        let with = |option, value: usize| (option, Some(Said { option, value: Some(value.to_string()) }));
        let perhaps = |option, value: Option<usize>| value.map_or((option, None), |value| with(option, value));
        let factor = self.method.factor();
        let mode = Said { option: "--mode", value: Some(self.mode.name().to_string()) };
        let mut options = vec![("--mode", Some(mode)), with("--factor", factor)];
        if self.mode.draws_in_learning() {
            options.push(("--seed", Some(Said { option: "--seed", value: Some(self.seed.to_string()) })));
        }
        if let Some(model) = self.method.model() {
            options.extend([
                with("--patch", model.side),
                perhaps("--step", model.spacing().ok()),
                with("--sparsity", model.sparsity),
                ("--unsigned", (!model.signed).then_some(Said { option: "--unsigned", value: None })),
                perhaps("--atoms", model.atoms),
                perhaps("--patches", model.patches),
                with("--by", model.by.unwrap_or(factor)),
            ]);
        }
        options
    }

    /// Looks whether what was said is what it was learned with.
    ///
    /// # Errors
    /// A usage error that names both.
    pub(in super::super) fn agree(&self, path: &Path, said: &[Said]) -> Result<()> {
        let own = self.options();
        let file = exemplar::name(path);
        for said in said {
            let found = own.iter().find(|(option, _)| *option == said.option).map(|(_, own)| own.as_ref());
            let words = match found {
                // The terrain that is drawn has a seed of its own.
                None if said.option == "--seed" => continue,
                Some(Some(own)) if own == said => continue,
                Some(Some(own)) => format!("with {}", own.words()),
                Some(None) => format!("without {}", said.option),
                None => format!("with --mode {}, and it is for --mode {} only", self.mode.name(), Mode::Paper.name()),
            };
            let message =
                format!("{}: {file} was learned {words}; leave the option away, or learn again", said.words());
            return Err(Error::usage(message));
        }
        Ok(())
    }
}
