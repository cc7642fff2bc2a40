use super::{Expr, ExprError, Program, sums};
use proptest::prelude::*;

fn parse(text: &str) -> Expr {
    Expr::parse(text, &["u", "v", "t"]).unwrap()
}

fn at(text: &str, values: [f64; 3]) -> f64 {
    parse(text).eval(&values).unwrap()
}

fn wrong(text: &str) -> String {
    Expr::parse(text, &["u", "v", "t"]).unwrap_err().to_string()
}

#[test]
fn precedence_is_the_usual_one() {
    let none = [0.0; 3];
    assert_eq!(at("1 + 2*3^2", none), 19.0);
    assert_eq!(at("-2^2", none), -4.0);
    assert_eq!(at("2^3^2", none), 512.0);
    assert_eq!(at("2^-2", none), 0.25);
    assert_eq!(at("8/4/2 - 3 - 2", none), -4.0);
    assert_eq!(at("-(1 - -2)*+3", none), -9.0);
    assert_eq!(at("2e3 + .5 + 1. + 1E-1", none), 2001.6);
    assert_eq!(at("pow(2, 10) + atan2(0, 1) + min(3, 2) - max(1, 4)", none), 1022.0);
    assert_eq!(at("sign(-3) + sign(0) + sign(9) + floor(-0.5) + ceil(0.5)", none), 0.0);
}

#[test]
fn variables_and_constants() {
    assert_eq!(at("u + 10*v + 100*t", [1.0, 2.0, 3.0]), 321.0);
    assert_eq!(at("log(e) + cos(pi) + sin(tau/4) + ln(1)", [0.0; 3]), 1.0);
    // a variable hides a constant of its name
    assert_eq!(Expr::parse("2*e", &["e"]).unwrap().eval(&[4.0]), Ok(8.0));
}

#[test]
fn errors_say_where_and_what() {
    assert_eq!(
        wrong("sin(v) + cso(t)"),
        "character 10: unknown function `cso`; did you mean `cos`?"
    );
    assert_eq!(wrong("2*w"), "character 3: unknown variable `w` (known here: u, v, t)");
    assert_eq!(wrong("sin + 1"), "character 1: `sin` is a function; write `sin(...)`");
    assert_eq!(wrong("v(t+1)"), "character 1: `v` is no function; a product is written `v*(...)`");
    assert_eq!(
        wrong("2v"),
        "character 2: expected an operator, found `v`; a product is written with `*`"
    );
    assert_eq!(wrong("1 +"), "character 4: expected a number, a name or `(`, found the end");
    assert_eq!(wrong(""), "character 1: expected a number, a name or `(`, found the end");
    assert_eq!(wrong("(1 + 2"), "character 7: expected `)` after the parenthesis, found the end");
    assert_eq!(wrong("1)"), "character 2: `)` without a `(` before it");
    assert_eq!(
        wrong("atan2(1)"),
        "character 8: expected `,` after argument 1 of `atan2`, which takes 2, found `)`"
    );
    assert_eq!(wrong("sin(1, 2)"), "character 6: too many arguments, `sin` takes 1");
    assert_eq!(wrong("2**3"), "character 2: `**` is no operator; a power is written `^`");
    assert_eq!(wrong("ü + 1 $"), "character 1: unknown variable `ü` (known here: u, v, t)");
    assert_eq!(wrong("1 ; 2"), "character 3: `;` means nothing in an expression");
    assert_eq!(wrong("1e999"), "character 1: `1e999` is no number");
    assert_eq!(wrong("."), "character 1: `.` is no number");
}

#[test]
fn depth_and_length_are_limited() {
    let deep = format!("{}1{}", "(".repeat(5000 / 4), ")".repeat(5000 / 4));
    assert!(wrong(&deep).contains("nested deeper than 64 levels"));
    assert!(wrong(&"-".repeat(2000)).contains("nested deeper than 64 levels"));
    assert!(wrong(&"2^".repeat(2000)).contains("nested deeper than 64 levels"));
    assert!(wrong(&"1+".repeat(3000)).contains("more than 4096 bytes"));
    // width is no depth
    assert_eq!(at(&format!("0{}", "+1".repeat(2000)), [0.0; 3]), 2000.0);
    // repeated derivatives of a long product are refused, not computed for minutes
    let mut f = parse(&(1..300).fold("v".to_owned(), |f, i| format!("{f}*(v+{i})^v")));
    let refused = (0..12).find_map(|_| match f.derivative(1) {
        Ok(next) => {
            f = next;
            None
        }
        Err(e) => Some(e),
    });
    let most = super::MOST;
    let expected = ExprError::Size { what: "the derivative", most, of: "operations" };
    assert_eq!(refused, Some(expected));
}

#[test]
fn values_that_do_not_exist_are_errors() {
    let fault = |text: &str| parse(text).eval(&[-1.0, 0.0, 0.5]).unwrap_err().to_string();
    let place = "at u = -1, v = 0, t = 0.5";
    assert_eq!(fault("1 + sin(v)/v"), format!("division by zero in `sin(v)/v` {place}"));
    assert_eq!(fault("v^(-2)"), format!("division by zero in `v^-2` {place}"));
    assert_eq!(fault("u^t"), format!("a negative number to a fractional power in `u^t` {place}"));
    assert_eq!(fault("sqrt(u)"), format!("square root of a negative number in `sqrt(u)` {place}"));
    assert_eq!(
        fault("log(v)"),
        format!("logarithm of a number that is not positive in `log(v)` {place}")
    );
    assert_eq!(fault("asin(2)"), format!("asin or acos outside [-1, 1] in `asin(2)` {place}"));
    assert_eq!(fault("exp(1000)"), format!("overflow in `exp(1000)` {place}"));
    // an infinity on the way counts, even where the result would be finite
    assert_eq!(fault("atan(1/v)"), format!("division by zero in `1/v` {place}"));
    let e = parse("u").eval(&[1.0]).unwrap_err();
    assert_eq!(e.to_string(), "got 1 values, expected 3");
    assert!(parse("u").eval(&[f64::NAN, 0.0, 0.0]).is_err());
}

#[test]
fn derivatives_known_by_hand() {
    let d = |text: &str| parse(text).derivative(1).unwrap().to_string();
    assert_eq!(d("3*t"), "0");
    assert_eq!(d("3*v + u"), "3");
    assert_eq!(d("v^2"), "2*v");
    assert_eq!(d("sin(v)"), "cos(v)");
    assert_eq!(d("exp(-t)*cos(v)"), "exp(-t)*-sin(v)");
    // powers at zero are no logarithms of zero
    assert_eq!(parse("v^3").derivative(1).unwrap().eval(&[0.0; 3]), Ok(0.0));
    // corners take the mean
    let corner = parse("abs(v) + max(v, 0) + min(v, 3*v)").derivative(1).unwrap();
    assert_eq!(corner.eval(&[0.0, 0.0, 0.0]), Ok(2.5));
    assert_eq!(corner.eval(&[0.0, 1.0, 0.0]), Ok(3.0));
    assert_eq!(corner.eval(&[0.0, -1.0, 0.0]), Ok(2.0));
}

#[test]
fn fourth_derivatives_are_exact() {
    let mut f = parse("exp(0.5*t)*sin(2*v)");
    for _ in 0..4 {
        f = f.derivative(1).unwrap();
    }
    let exact = 16.0 * 0.5f64.exp() * 1.4f64.sin();
    assert!((f.eval(&[0.0, 0.7, 1.0]).unwrap() - exact).abs() < 1e-13);
}

#[test]
fn holding_a_variable_folds_it_away() {
    let held = parse("exp(t)*sin(v)").with(2, 0.0);
    assert_eq!(held.to_string(), "1*sin(v)");
    assert!(held.depends_on(1) && !held.depends_on(2));
    // what has no value stays, to be reported with the place
    let e = parse("v/t").with(2, 0.0).eval(&[0.0, 1.0, 0.0]).unwrap_err();
    assert_eq!(e.to_string(), "division by zero in `v/0` at u = 0, v = 1, t = 0");
    assert_eq!(parse("2*3").with(0, 1.0).as_number(), Some(6.0));
}

#[test]
fn expressions_combine() {
    let (f, g) = (parse("v + 1"), parse("sin(t)"));
    let x = [0.0, 2.0, 0.5];
    assert_eq!(f.plus(&g).eval(&x), Ok(3.0 + 0.5f64.sin()));
    assert_eq!(f.times(&g).scaled(2.0).eval(&x), Ok(2.0 * (3.0 * 0.5f64.sin())));
    assert_eq!(f.over(&["t", "v"]).unwrap().eval(&[9.0, 2.0]), Ok(3.0));
    assert!(f.over(&["t"]).is_none());
}

#[test]
fn programs_give_the_same_values() {
    let all = ["sin(v)*t", "sin(v) + u", "3"].map(parse);
    let program = Program::new(&all);
    let (x, mut out) = ([0.3, 0.4, 0.5], [0.0; 3]);
    program.eval(&x, &mut out).unwrap();
    assert_eq!(out, all.map(|e| e.eval(&x).unwrap()));
    assert_eq!(program.len(), 3);
}

#[test]
fn sums_multiply_out() {
    // paper 002, eq. 29, first component
    let text = "(1 - t)*(2*sinh(0.5*v + 1) + 3*sin(3*v)) + 7*t*cos(-v)";
    let sums = sums(&[parse(text), parse("4*t*cos(-v) - sin(3*v)/2"), parse("v - v")]);
    let names: Vec<String> = sums.functions.iter().map(ToString::to_string).collect();
    assert_eq!(
        names,
        ["sinh(0.5*v + 1)", "sin(3*v)", "t*sinh(0.5*v + 1)", "t*sin(3*v)", "t*cos(-v)"]
    );
    assert_eq!(sums.terms[0], [(0, 2.0), (1, 3.0), (2, -2.0), (3, -3.0), (4, 7.0)]);
    assert_eq!(sums.terms[1], [(4, 4.0), (1, -0.5)]);
    assert_eq!(sums.terms[2], []);
}

#[test]
fn wide_sums_stay_whole() {
    let sums = sums(&[parse("(u + v + t + 1)^9 + 5")]);
    assert_eq!(sums.functions.len(), 2);
    assert_eq!(sums.functions[0].to_string(), "(u + v + t + 1)^9");
}

/// Expressions that are smooth and tame on [0.2, 0.9]^3.
fn smooth() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("u".to_owned()),
        Just("v".to_owned()),
        Just("t".to_owned()),
        (1..40u32).prop_map(|n| format!("{}", f64::from(n) / 8.0)),
    ];
    leaf.prop_recursive(4, 24, 2, |inner| {
        let one = prop_oneof![
            Just("sin("),
            Just("cos("),
            Just("atan("),
            Just("tanh("),
            Just("-("),
            Just("exp(-1 - tanh("),
            Just("log(2 + tanh("),
            Just("sqrt(2 + sin("),
            Just("1/(3 + cos("),
            Just("sinh(tanh("),
            Just("cosh(sin("),
            Just("tan(0.5*sin("),
            Just("asin(0.5*sin("),
            Just("acos(0.5*cos("),
        ];
        let two = prop_oneof![
            Just(("", " + ")),
            Just(("", " - ")),
            Just(("", "*")),
            Just(("atan2(2 + sin(", "), 3 + cos(")),
            Just(("(2 + cos(", "))^(1 + sin(")),
        ];
        prop_oneof![
            (one, inner.clone()).prop_map(|(f, a)| {
                let close = ")".repeat(f.matches('(').count());
                format!("{f}{a}{close}")
            }),
            (two, inner.clone(), inner).prop_map(|((open, mid), a, b)| match mid {
                " + " | " - " | "*" => format!("({a}{mid}({b}))"),
                "))^(1 + sin(" => format!("({open}{a}{mid}{b})))"),
                _ => format!("{open}{a}{mid}{b}))"),
            }),
        ]
    })
}

proptest! {
    #[test]
    fn derivatives_match_differences(text in smooth(), x in prop::array::uniform3(0.2..0.9f64)) {
        let f = Expr::parse(&text, &["u", "v", "t"]).unwrap();
        for i in 0..3 {
            let (h, mut a, mut b) = (1e-3, [x; 2], [x; 2]);
            (a[0][i], a[1][i], b[0][i], b[1][i]) = (x[i] + h, x[i] - h, x[i] + 2.0 * h, x[i] - 2.0 * h);
            let f = |x: [f64; 3]| f.eval(&x).unwrap();
            let rough = (8.0 * (f(a[0]) - f(a[1])) - (f(b[0]) - f(b[1]))) / (12.0 * h);
            let exact = parse(&text).derivative(i).unwrap().eval(&x).unwrap();
            // fourth-order differences: h^4 times a fifth derivative that nesting makes large
            prop_assert!((rough - exact).abs() <= 1e-5 * (1.0 + exact.abs()), "{exact} {rough}");
        }
    }

    #[test]
    fn text_reads_back(text in smooth(), x in prop::array::uniform3(0.2..0.9f64)) {
        let f = parse(&text);
        for g in [f.clone(), f.derivative(1).unwrap()] {
            let again = parse_long(&g.to_string());
            if let Some(again) = again {
                prop_assert_eq!(g.eval(&x), again.eval(&x));
                prop_assert_eq!(g.to_string(), again.to_string());
            }
        }
    }

    #[test]
    fn sums_add_up(text in smooth(), x in prop::array::uniform3(0.2..0.9f64)) {
        let f = parse(&text);
        let sums = sums(std::slice::from_ref(&f));
        let value: f64 =
            sums.terms[0].iter().map(|&(j, c)| c * sums.functions[j].eval(&x).unwrap()).sum();
        let size: f64 =
            sums.terms[0].iter().map(|&(j, c)| (c * sums.functions[j].eval(&x).unwrap()).abs()).sum();
        prop_assert!((value - f.eval(&x).unwrap()).abs() <= 1e-12 * (1.0 + size));
    }
}

/// Text that may be too long or too deep to be read.
fn parse_long(text: &str) -> Option<Expr> {
    match Expr::parse(text, &["u", "v", "t"]) {
        Ok(e) => Some(e),
        Err(ExprError::Size { .. }) => None,
        Err(e) => {
            assert!(e.to_string().contains("nested deeper"), "{text}: {e}");
            None
        }
    }
}

#[test]
fn mutated_texts_never_panic() {
    let seeds = [
        "(1-t)*(1.2*sinh(0.5*v+0.1)+0.3*sin(3*v))+2*t*cos(-v)",
        "atan2(u, max(v, -1e-3))^2/(1 + abs(t)) - floor(pi*e)*min(u,v)",
        "2^-3^sqrt(u)*-(-tan(v))/log(t)+pow(u,v)",
    ];
    let pool: Vec<char> = "0123456789.eE+-*/^(),uvtsincoxp_ πé\u{0}\n∞".chars().collect();
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = |n: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as usize % n.max(1)
    };
    let mut read = 0;
    for i in 0..20_000 {
        let mut text: Vec<char> = seeds[i % seeds.len()].chars().collect();
        for _ in 0..1 + random(4) {
            let place = random(text.len());
            match random(4) {
                0 => text[place] = pool[random(pool.len())],
                1 => text.insert(place, pool[random(pool.len())]),
                2 => drop(text.remove(place)),
                _ => {
                    let piece: Vec<char> = text[place..].iter().take(random(9)).copied().collect();
                    let to = random(text.len());
                    text.splice(to..to, piece);
                }
            }
        }
        let text: String = text.into_iter().collect();
        let Ok(e) = Expr::parse(&text, &["u", "v", "t"]) else { continue };
        read += 1;
        for x in [[0.0; 3], [0.5, -1.0, 2.0], [-1e300, 1e300, 1e-300]] {
            let value = e.eval(&x);
            assert!(value.is_err() || value.is_ok_and(f64::is_finite), "{text}");
            let _ = e.derivative(1).map(|d| d.eval(&x).is_ok());
            let _ = e.with(2, x[2]).eval(&x);
        }
        let _ = (e.to_string(), sums(&[e]));
    }
    assert!(read > 1000, "{read}");
}
