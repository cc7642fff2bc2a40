//! Runs that are killed, and places that cannot be written: no half file, and a plain word.

use crate::util::{Folder, Random, block};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("low.obj", &block([0.0, 0.0, 5.0], [10.0, 10.0, 5.0]));
    folder.put("tall.obj", &block([0.0, 0.0, 15.0], [5.0, 5.0, 15.0]));
    folder
}

/// Writes meshes, pictures and a report.
const MANY: [&str; 16] = [
    "morph",
    "low.obj",
    "tall.obj",
    "--method",
    "linear",
    "-t",
    "0:1:0.5",
    "-o",
    "h-{t}.stl",
    "--picture",
    "h-{t}.png",
    "--resolution",
    "48",
    "--threads",
    "2",
    "--force",
];

/// Whether a file is all there.
fn whole(path: &Path) -> bool {
    if path.is_dir() {
        return true;
    }
    let bytes = fs::read(path).unwrap();
    match path.extension().and_then(|e| e.to_str()) {
        Some("stl") => {
            let count = bytes.get(80..84).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
            count.is_some_and(|n| bytes.len() == 84 + 50 * n as usize)
        }
        Some("png") => bytes.ends_with(b"IEND\xaeB`\x82"),
        Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes).is_ok(),
        Some("toml") => String::from_utf8(bytes).unwrap().parse::<toml::Table>().is_ok(),
        _ => true,
    }
}

/// What is not whole, and no hidden file of a run that may still be cleared away.
fn halves(folder: &Folder) -> Vec<String> {
    let shown = folder.names().into_iter().filter(|n| !n.starts_with(".fieldgraft-"));
    shown.filter(|n| !whole(&folder.join(n))).collect()
}

/// Hidden files of runs.
fn hidden(folder: &Folder) -> Vec<String> {
    folder.names().into_iter().filter(|n| n.starts_with(".fieldgraft-")).collect()
}

/// Waits for a moment at which a file is being written: a hidden one is there. Whether there was one
/// before the run ended.
#[cfg(unix)]
fn writing(folder: &Folder, child: &mut std::process::Child) -> bool {
    while child.try_wait().unwrap().is_none() {
        if !hidden(folder).is_empty() {
            return true;
        }
    }
    false
}

/// Kills are spread over the length of a run that nobody disturbs. Every other one is aimed at the
/// writing of a file; what an earlier kill left is taken away for it, and for the others it stays.
/// `FIELDGRAFT_KILLS=200` kills as often.
#[cfg(unix)]
#[test]
fn a_killed_run_leaves_no_half_file_and_the_next_clears_up() {
    let kills = std::env::var("FIELDGRAFT_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(6);
    let folder = folder();
    let start = Instant::now();
    folder.run(&MANY).ends(0);
    let length = start.elapsed();
    let mut random = Random::new(6);
    let (mut left, mut cut, mut aimed) = (0, 0, 0);
    for nth in 0..kills {
        if nth % 2 == 1 {
            hidden(&folder).iter().for_each(|n| fs::remove_file(folder.join(n)).unwrap());
        }
        let mut child =
            folder.command(&MANY).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(length.mul_f64(random.share()));
        if nth % 2 == 1 {
            aimed += usize::from(writing(&folder, &mut child));
        }
        // on Unix this is kill -9; the run may have ended already
        let _ = child.kill();
        cut += usize::from(!child.wait().unwrap().success());
        assert_eq!(halves(&folder), Vec::<String>::new());
        left += hidden(&folder).len();
    }
    println!(
        "{kills} kills over {length:.2?}, {cut} before the end, {aimed} while a file was written, \
         left {left} hidden files"
    );
    folder.put(".fieldgraft-4000000000-abc.part", "half");
    folder.run(&MANY).ends(0);
    if cfg!(target_os = "linux") {
        assert_eq!(hidden(&folder), Vec::<String>::new());
    }
    assert_eq!(halves(&folder), Vec::<String>::new());
    assert_eq!(folder.names().iter().filter(|n| n.ends_with(".stl")).count(), 3);
}

#[cfg(unix)]
#[test]
fn interrupted_at_any_moment_it_says_so_and_clears_up() {
    let folder = folder();
    let mut random = Random::new(9);
    for _ in 0..4 {
        let child = folder.command(&MANY).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let child = child.unwrap();
        std::thread::sleep(Duration::from_millis(100 + random.below(600) as u64));
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        let done = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        let code = done.status.code();
        // it may have been done already, or not have begun
        let heard = code == Some(130) && text.contains("error: interrupted");
        assert!(heard || code == Some(0) || code.is_none() || !sent.success(), "{code:?} {text}");
        assert_eq!(halves(&folder), Vec::<String>::new());
        assert!(!folder.names().iter().any(|n| n.starts_with('.')), "{:?}", folder.names());
    }
}

/// `check` asks nobody between its steps; it ends all the same.
#[cfg(unix)]
#[test]
fn work_that_does_not_listen_is_ended_too() {
    let n = 250;
    let point = |i: usize| format!("v {} {} {}\n", i % n, i / n, i * i % 7);
    let face = |i: usize| {
        let a = i / (n - 1) * n + i % (n - 1) + 1;
        format!("f {a} {} {} {}\n", a + 1, a + n + 1, a + n)
    };
    let text: String = (0..n * n).map(point).chain((0..(n - 1) * (n - 1)).map(face)).collect();
    let folder = Folder::new();
    folder.put("hills.obj", &text);
    let mut child = folder.command(&["check", "hills.obj"]);
    let child = child.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(150));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let done = child.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&done.stderr).into_owned();
    // it may have been done already, or not have begun
    let said = text.matches("error: interrupted").count();
    assert!(matches!(done.status.code(), Some(130 | 0) | None), "{:?} {text}", done.status);
    assert_eq!(said, usize::from(done.status.code() == Some(130)), "{text}");
}

/// Runs the command under a limit of the shell's.
#[cfg(target_os = "linux")]
fn limited(folder: &Folder, limit: &str, args: &[&str]) -> (Option<i32>, String) {
    let line = format!("{limit}; exec \"$0\" \"$@\"");
    let done = Command::new("sh")
        .args(["-c", &line, env!("CARGO_BIN_EXE_fieldgraft")])
        .args(args)
        .env_remove("RUST_BACKTRACE")
        .current_dir(folder.path())
        .output()
        .unwrap();
    (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
}

/// A limit on the size of files, its signal ignored, is a disk that is full at any byte.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_leaves_nothing() {
    let folder = folder();
    let before = folder.names();
    for (args, named) in [
        (&["convert", "low.obj", "x.stl", "--resolution", "48"][..], "x.stl"),
        (&["convert", "low.obj", "x.npy", "--resolution", "48"], "x.npy"),
        (&["convert", "low.obj", "x.glb", "--resolution", "48"], "x.glb"),
        (&["picture", "low.obj", "-o", "x.png"], "x.png"),
    ] {
        let (code, text) = limited(&folder, "trap '' XFSZ; ulimit -f 2", args);
        assert!(matches!(code, Some(1 | 3)), "{args:?}: {code:?} {text}");
        assert!(text.contains("error: ") && text.contains(named), "{args:?}: {text}");
        assert!(text.contains("File too large"), "{args:?}: {text}");
        assert_eq!(folder.names(), before, "{args:?}");
    }
    // standard output on a device that is always full
    let (code, text) = limited(&folder, "exec >/dev/full", &["schema"]);
    assert!(code == Some(1) && text.contains("stdout: cannot be written"), "{code:?} {text}");
}

/// A real small disk, where one may be mounted; elsewhere it is said that it was skipped.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_of_memory() {
    let folder = folder();
    fs::create_dir(folder.join("disk")).unwrap();
    let mount =
        |args: &[&str]| Command::new(args[0]).args(&args[1..]).current_dir(folder.path()).output();
    let mounted = mount(&["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", "disk"]);
    if !mounted.is_ok_and(|m| m.status.success()) {
        println!("skipped: no tmpfs may be mounted here");
        return;
    }
    let ran = folder.run(&["convert", "low.obj", "disk/x.stl", "--resolution", "64"]);
    let left: Vec<_> = fs::read_dir(folder.join("disk")).unwrap().flatten().collect();
    let left: Vec<_> = left.iter().map(|e| e.file_name()).collect();
    mount(&["umount", "disk"]).unwrap();
    assert!(ran.code() == 1 || ran.code() == 3, "{ran}");
    assert!(ran.stderr().contains("x.stl") && ran.stderr().contains("No space left"), "{ran}");
    assert!(left.is_empty(), "{left:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_said() {
    let folder = folder();
    // nobody can make a file there, not even root
    for place in ["/proc/x.stl", "/sys/x.stl", "gone/x.stl", "low.obj/x.stl"] {
        let ran = folder.run(&["convert", "low.obj", place, "--resolution", "16"]);
        assert!(matches!(ran.code(), 1..=3), "{ran}");
        assert!(ran.stderr().contains("error: ") && ran.stderr().contains(place), "{ran}");
        assert!(ran.stderr().lines().count() <= 6, "{ran}");
    }
    assert_eq!(folder.names(), ["low.obj", "tall.obj"]);
}

/// Threads whose stacks do not fit are refused in a line; what needs none is done.
#[cfg(target_os = "linux")]
#[test]
fn more_threads_than_fit_are_refused() {
    let folder = folder();
    let limit = format!("ulimit -v {}", 400 * 1024);
    let (code, text) = limited(&folder, &limit, &["check", "low.obj", "--threads", "400"]);
    assert!(
        code == Some(5) && text.contains("error: not enough memory to start threads"),
        "{text}"
    );
    let (code, text) = limited(&folder, &limit, &["schema", "--threads", "400"]);
    assert_eq!((code, text.as_str()), (Some(0), ""));
}

/// Whatever address space there is, and whatever the command: its result, or a refusal, but no death.
#[cfg(target_os = "linux")]
#[test]
fn too_little_memory_is_an_error_and_no_abort() {
    let folder = folder();
    let solid = |at: &str| format!("solid = {{ parts = [{{ box = {{ {at} }} }}] }}\n");
    let (a, b) =
        ("center = [0, 0, 5], size = [20, 20, 10]", "center = [0, 0, 9], size = [8, 8, 18]");
    let morph = "[morph]\nmethod = \"space-time\"\nbetween = [\"a\", \"b\"]\n";
    let shapes = format!("[shapes.a]\n{}[shapes.b]\n{}", solid(a), solid(b));
    folder.put("r.toml", &format!("version = 1\n[grid]\nresolution = 64\n{shapes}{morph}"));
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/surfaces/klein-bottle.toml");
    let surface = surface.to_str().unwrap();
    let commands: [&[&str]; 8] = [
        &["convert", "low.obj", "x.stl", "--resolution", "96"],
        &["morph", "low.obj", "tall.obj", "-o", "y.stl", "--resolution", "48"],
        &["run", "r.toml", "-o", "run"],
        &[
            "compare",
            "r.toml",
            "-o",
            "compare",
            "--resolution",
            "24",
            "--methods",
            "linear,transport",
        ],
        &["check", "low.obj"],
        &["picture", "low.obj", "-o", "z.png"],
        &["surface", surface, "--samples", "60x60", "-o", "s.csv"],
        &["features", "suggest", "low.obj", "tall.obj", "-o", "f.toml"],
    ];
    let (mut refused, mut done) = (0, 0);
    for args in commands {
        let more: &[&str] = if args[0] == "check" { &[] } else { &["--force"] };
        let args = [args, &["--threads", "2"], more].concat();
        for mib in [20, 32, 64, 160] {
            let (code, text) = limited(&folder, &format!("ulimit -v {}", mib * 1024), &args);
            // of boxes no chair is suggested
            let fine = code == Some(0) || args[0] == "features" && code == Some(3);
            assert!(fine || matches!(code, Some(1 | 5)), "{mib} MiB, {args:?}: {code:?} {text}");
            done += usize::from(fine);
            if !fine {
                refused += 1;
                assert!(text.contains("error"), "{mib} MiB, {args:?}: {text}");
            }
            assert!(!folder.names().iter().any(|n| n.starts_with('.')), "{:?}", folder.names());
            assert_eq!(halves(&folder), Vec::<String>::new());
        }
    }
    println!("{done} runs within their address space, {refused} refused");
    assert!(refused > 0 && done > 0, "{done} done, {refused} refused");
}
