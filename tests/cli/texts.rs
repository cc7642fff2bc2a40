use crate::util::Folder;
use std::process::Stdio;

#[test]
fn the_schema_is_json_and_holds_the_keys() {
    let ran = Folder::new().run(&["schema"]).ends(0);
    let schema: serde_json::Value = serde_json::from_str(&ran.stdout()).unwrap();
    let keys = schema["properties"].as_object().unwrap();
    for key in ["version", "shapes", "features", "morph", "hybrids", "grid", "output"] {
        assert!(keys.contains_key(key), "{key}");
    }
    assert_eq!(schema["additionalProperties"], false);
    assert!(ran.stderr().is_empty());
}

#[test]
fn completions_and_manual_pages_are_printed() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let text = folder.run(&["completions", shell]).ends(0).stdout();
        assert!(text.contains("fieldgraft") && text.contains("convert"), "{shell}");
    }
    assert!(folder.run(&["man"]).ends(0).stdout().contains(".TH fieldgraft"));
    assert!(folder.run(&["man", "morph"]).ends(0).stdout().contains("weights"));
    folder.run(&["man", "moprh"]).fails(2, &["did you mean `morph`?"]);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let mut child = Folder::new()
        .command(&["schema"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0));
}
