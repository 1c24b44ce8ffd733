//! What README.md shows of the program is what it prints.

use super::{Run, folder, link, root};
use std::fs;

/// The lines between "```console" and "```".
fn blocks(readme: &str) -> Vec<&str> {
    readme.split("```console\n").skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

/// A text without the seconds that end some of its lines: they differ from run to run.
fn timeless(text: &str) -> String {
    let line = |line: &str| match line.rsplit_once(", ") {
        Some((said, time)) if time.strip_suffix(" s").is_some_and(|time| time.parse::<f64>().is_ok()) => {
            said.to_string()
        }
        _ => line.to_string(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn its_outputs_are_real() {
    let readme = fs::read_to_string(root().join("README.md")).expect("README.md");
    let dir = folder();
    link(&root().join("fixtures"), &dir.path().join("fixtures"));
    let mut commands = 0;
    for block in blocks(&readme) {
        for shown in block.split("$ orograph ").skip(1) {
            let (command, shown) = shown.split_once('\n').expect("a command and what it prints");
            let run = Run::in_folder(dir.path(), &command.split_whitespace().collect::<Vec<_>>());
            run.expect(0, "");
            assert_eq!(
                timeless(&run.stdout()),
                timeless(shown),
                "README.md shows something else of: orograph {command}"
            );
            commands += 1;
        }
    }
    assert!(commands >= 2, "README.md shows {commands} commands with what they print");
}
