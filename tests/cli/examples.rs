//! What `--help` shows as examples works as it stands.

use super::{PROGRAM, Run, folder, link, listing, root};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The verbs that the program's own help lists, each with those below it.
fn verbs() -> Vec<Vec<String>> {
    let mut found = vec![];
    for verb in listed(&Run::done(&["--help"])).expect("a list of commands") {
        let below = listed(&Run::done(&[&verb, "--help"])).unwrap_or_default();
        found.extend(below.into_iter().map(|second| vec![verb.clone(), second]));
        found.push(vec![verb]);
    }
    found
}

/// The verbs that a help lists, if it lists any.
fn listed(run: &Run) -> Option<Vec<String>> {
    let help = run.stdout();
    let commands = help.split("Commands:\n").nth(1)?;
    let lines = commands.lines().take_while(|line| !line.is_empty());
    // Deeper lines go on with the description above.
    let names = lines.filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.filter_map(|line| line.split_whitespace().next());
    Some(names.filter(|&verb| verb != "help").map(String::from).collect())
}

/// The command lines of the block of examples that ends a verb's help.
fn examples(verb: &[String]) -> Vec<String> {
    let words: Vec<&str> = verb.iter().map(String::as_str).chain(["--help"]).collect();
    let run = Run::done(&words);
    let help = run.stdout();
    let start = help.rfind("\nExample");
    run.check(start.is_some(), "a block of examples");
    let block = help[start.expect("checked") + 1..].trim_end();
    let (title, lines) = block.split_once('\n').expect("a title and lines");
    run.check(matches!(title, "Example:" | "Examples:"), "a title");
    run.check(lines.lines().all(|line| line.starts_with("  orograph ")), "nothing but command lines after it");
    lines.lines().map(|line| line.trim().to_string()).collect()
}

#[test]
fn they_run() {
    let verbs = verbs();
    assert!(
        [
            "amplify",
            "classify",
            "classify predict",
            "classify train",
            "decode",
            "encode",
            "info",
            "learn",
            "map",
            "peaks",
            "scene",
            "scene eval",
            "stats",
            "synthesize",
            "terrain",
            "tin",
            "verify"
        ]
        .iter()
        .all(|known| verbs.iter().any(|verb| verb.join(" ") == *known)),
        "{verbs:?}"
    );
    for verb in verbs {
        // Later examples of a verb may use what earlier ones have made.
        let dir = folder();
        link(&root().join("fixtures"), &dir.path().join("fixtures"));
        let mut made = BTreeSet::new();
        for example in examples(&verb) {
            let words: Vec<&str> = example.split_whitespace().skip(1).collect();
            let run = Run::in_folder(dir.path(), &words);
            run.expect(0, "");
            // A class is named before its file.
            let files = words.iter().map(|word| word.split_once('=').map_or(*word, |(_, file)| file));
            let is_output = |word: &&str| !word.contains(',') && Path::new(word).extension().is_some();
            let outputs: Vec<&str> = files.filter(|word| !word.starts_with("fixtures/")).filter(is_output).collect();
            for output in &outputs {
                let bytes = fs::metadata(dir.path().join(output)).map(|file| file.len());
                run.check(bytes.is_ok_and(|bytes| bytes > 0), &format!("the file {output}"));
            }
            made.extend(outputs.iter().map(ToString::to_string));
            let found = listing(dir.path()).len() - 1;
            run.check(found == made.len(), "no other files");
        }
    }
}

#[test]
fn versions_are_told() {
    let said = Run::done(&["--version"]).stdout();
    assert!(said.starts_with(&format!("orograph {}\nGDAL 3", env!("CARGO_PKG_VERSION"))), "{PROGRAM}: {said}");
    assert!(said.contains("\nPROJ "), "{said}");
}
