//! The macros on structs as other crates declare them.

use incise_params::{Kind, Params, Range, Value, resolve, short_name};

incise_params::choices! {
    /// Time integration.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Integrator {
        /// Of first order.
        Euler = "euler",
        /// Of second order.
        Bdf2 = "bdf2",
    }
}

incise_params::variants! {
    /// Stiffness.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Stiffness = Self::Pbd(1.0);
    names {}
    values {
        /// From 0 to 1.
        Pbd(f32) = "stiffness", range: Range::FRACTION;
        /// Inverse.
        Compliance(f32) = "compliance", range: Range::NOT_NEGATIVE, unit: "m/N";
    }
}

incise_params::variants! {
    /// Level.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Level = Self::Original;
    names {
        /// As long.
        Original = "original";
        /// Two thirds.
        Finer1_5 = "1.5x-finer";
        /// Half.
        Finer2 = "2x-finer";
    }
    values {
        /// Any.
        Z(f64) = "z", range: Range::POSITIVE;
    }
}

incise_params::params! {
    /// Contacts.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Contacts {
        /// Distance.
        thickness: f32 = 0.1, range: Range::POSITIVE.up_to(100.0);
        /// Within a piece.
        self_collision: bool = false;
    }
}

incise_params::params! {
    /// All kinds of parameters.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct Scene {
        /// Duration.
        dt: f32 = 1.0 / 60.0, range: Range::POSITIVE, unit: "s";
        /// Gravity.
        gravity: [f32; 3] = [0.0, -9.81, 0.0], unit: "m/s^2";
        /// Ground.
        ground: Option<f32> = None, unit: "m";
        /// Substeps.
        substeps: u32 = 16, range: Range::at_least(1.0);
        /// Integrator.
        integrator: Integrator = Integrator::Euler;
        /// Stretch.
        stretch: Stiffness = Stiffness::Pbd(1.0);
        /// Bending.
        bending: Option<Stiffness> = None;
        /// Level.
        level: Level = Level::Original;
        /// Contacts.
        contacts: Option<Contacts> = None;
    }
}

/// Sets parameters of a default scene by name.
fn set(entries: &[(&str, Value)]) -> Result<Scene, String> {
    let entries = entries
        .iter()
        .map(|(name, value)| ((*name).to_owned(), value.clone()));
    let mut scene = Scene::default();
    let set = incise_params::Parameter::set_value(&mut scene, &Value::Map(entries.collect()));
    set.map_err(|error| error.to_string())?;
    scene.check_ranges().map_err(|error| error.to_string())?;
    Ok(scene)
}

fn map(entries: &[(&str, Value)]) -> Value {
    Value::Map(
        entries
            .iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone()))
            .collect(),
    )
}

#[test]
fn a_struct_that_is_off_stays_off_beside_its_parts() {
    let thickness = Value::Number(0.2);
    for (name, off) in [
        ("contacts", Value::Flag(false)),
        ("contacts", Value::None),
        ("contacts", Value::Text("none".to_owned())),
        ("contacts.enabled", Value::Flag(false)),
    ] {
        let mut entries = [(name, off), ("contacts_thickness", thickness.clone())];
        for _ in 0..2 {
            entries.reverse();
            assert_eq!(set(&entries).unwrap().contacts, None, "{entries:?}");
        }
    }
}

#[test]
fn two_names_of_a_parameter_are_refused() {
    let entries = [
        ("thickness", Value::Number(0.2)),
        ("contacts.thickness", Value::Number(0.3)),
    ];
    assert_eq!(
        set(&entries).unwrap_err(),
        "'contacts.thickness' and 'thickness' are the same parameter; give one of them"
    );
    let entries = [
        ("thickness", Value::Number(0.2)),
        ("contacts", map(&[("thickness", Value::Number(0.3))])),
    ];
    let error = set(&entries).unwrap_err();
    assert!(error.contains("the same parameter"), "{error}");
}

#[test]
fn none_is_also_a_text() {
    let none = || Value::Text("none".to_owned());
    let scene = set(&[("ground", none()), ("bending", none())]).unwrap();
    assert_eq!((scene.ground, scene.bending), (None, None));
}

#[test]
fn whole_numbers_name_the_limit_of_their_type() {
    let error = set(&[("substeps", Value::Number(1e12))]).unwrap_err();
    assert!(error.contains("4294967295"), "{error}");
    let error = set(&[("substeps", Value::Number(-1.0))]).unwrap_err();
    assert_eq!(
        error,
        "substeps is -1; it must be a finite number of at least 1"
    );
}

#[test]
fn names_may_be_short_and_have_other_dots() {
    for (name, path) in [
        ("dt", "dt"),
        ("thickness", "contacts.thickness"),
        ("contacts-thickness", "contacts.thickness"),
        ("contacts_self_collision", "contacts.self_collision"),
        ("contacts.enabled", "contacts.enabled"),
        ("bending.compliance", "bending.compliance"),
    ] {
        assert_eq!(resolve(Scene::FIELDS, name), Ok(path.to_owned()));
    }
    for (path, short) in [("contacts.thickness", "contacts.thickness"), ("dt", "dt")] {
        assert_eq!(short_name(Scene::FIELDS, path), short);
    }
    let error = resolve(Scene::FIELDS, "compliance")
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("use one of stretch.compliance, bending.compliance"),
        "{error}"
    );
    let error = resolve(Scene::FIELDS, "substep").unwrap_err().to_string();
    assert!(error.starts_with("there is no parameter 'substep'; the names are dt, gravity"));
    assert!(error.contains("contacts.thickness"), "{error}");
}

#[test]
fn values_are_set_by_name() {
    let number = Value::Number;
    let scene = set(&[
        ("dt", Value::from("1/120")),
        (
            "gravity",
            Value::List(vec![number(0.0), number(1.0), Value::Count(2)]),
        ),
        ("ground", number(0.5)),
        ("substeps", Value::Number(4.0)),
        ("integrator", Value::from("bdf2")),
        ("stretch", map(&[("compliance", number(1e-4))])),
        ("bending.stiffness", number(0.25)),
        ("level", number(0.7)),
        ("thickness", number(0.3)),
    ]);
    let expected = Scene {
        dt: 1.0 / 120.0,
        gravity: [0.0, 1.0, 2.0],
        ground: Some(0.5),
        substeps: 4,
        integrator: Integrator::Bdf2,
        stretch: Stiffness::Compliance(1e-4),
        bending: Some(Stiffness::Pbd(0.25)),
        level: Level::Z(0.7),
        contacts: Some(Contacts {
            thickness: 0.3,
            ..Contacts::default()
        }),
    };
    assert_eq!(scene, Ok(expected));
    let mut off = expected;
    for (name, value) in [
        ("ground", Value::None),
        ("bending", Value::parse("none")),
        ("contacts.enabled", Value::Flag(false)),
        ("level", Value::from("1.5x-finer")),
    ] {
        off.set(name, &value).unwrap();
    }
    assert_eq!((off.ground, off.bending, off.contacts), (None, None, None));
    assert_eq!(off.level, Level::Finer1_5);
}

#[test]
fn optional_structs_are_switched() {
    let contacts = |value| set(&[("contacts", value)]).map(|scene| scene.contacts);
    let default = Contacts::default();
    assert_eq!(contacts(Value::Flag(true)), Ok(Some(default)));
    assert_eq!(contacts(Value::Flag(false)), Ok(None));
    assert_eq!(contacts(map(&[])), Ok(Some(default)));
    assert_eq!(contacts(map(&[("enabled", Value::Flag(false))])), Ok(None));
    let mut scene = Scene::default();
    assert_eq!(scene.get("contacts.enabled"), Ok(Value::Flag(false)));
    scene.set("contacts.enabled", &Value::Flag(true)).unwrap();
    assert_eq!(scene.get("contacts.enabled"), Ok(Value::Flag(true)));
    assert_eq!(
        scene.get("thickness"),
        Ok(Value::Number(0.1)),
        "the shortest decimal of 32 bits"
    );
}

#[test]
fn refusals_name_the_parameter_and_the_range() {
    for (name, value, message) in [
        (
            "dt",
            Value::Number(0.0),
            "dt is 0; it must be a finite number above 0",
        ),
        (
            "dt",
            Value::from("fast"),
            "dt is 'fast'; it must be a number",
        ),
        (
            "substeps",
            Value::Count(0),
            "substeps is 0; it must be a finite number of at least 1",
        ),
        (
            "substeps",
            Value::Number(1.5),
            "substeps is '1.5'; it must be a whole number",
        ),
        (
            "gravity",
            Value::Count(1),
            "gravity is '1'; it must be 3 numbers",
        ),
        (
            "ground",
            Value::from("low"),
            "ground is 'low'; it must be a number, or none",
        ),
        (
            "integrator",
            Value::from("rk4"),
            "integrator is 'rk4'; it must be one of euler, bdf2",
        ),
        (
            "stretch",
            Value::Number(1.0),
            "stretch is '1'; it must be one of { stiffness = a number }, { compliance = a number }",
        ),
        (
            "bending.stiffness",
            Value::Number(2.0),
            "bending.stiffness is 2; it must be from 0 to 1",
        ),
        (
            "thickness",
            Value::Number(200.0),
            "contacts.thickness is 200; it must be above 0 and at most 100",
        ),
        (
            "level",
            Value::from("fine"),
            "level is 'fine'; it must be one of original, 1.5x-finer, 2x-finer, ",
        ),
        (
            "contacts",
            Value::Count(1),
            "contacts is '1'; it must be true, false or values by name",
        ),
        (
            "contacts",
            map(&[("foo", Value::Count(1))]),
            "there is no parameter 'contacts.foo'; the names are thickness, self_collision",
        ),
    ] {
        let error = set(&[(name, value)]).unwrap_err();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn fields_describe_the_parameters() {
    let field = &Scene::FIELDS[0];
    assert_eq!(
        (field.name, field.unit, field.doc),
        ("dt", "s", " Duration.\n")
    );
    assert_eq!(
        (field.default)(),
        Value::Number(f64::from(1.0_f32 / 60.0).max(0.016_666_668))
    );
    assert!(matches!(Scene::FIELDS[1].kind, Kind::List(3, Kind::Number)));
    let names: Vec<String> = incise_params::all_fields(Scene::FIELDS)
        .into_iter()
        .map(|(n, _)| n)
        .collect();
    assert!(
        names.contains(&"contacts.thickness".to_owned()),
        "{names:?}"
    );
}

#[cfg(feature = "serde")]
mod serialized {
    use super::*;
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    enum DerivedLevel {
        Original,
        Finer1_5,
        Finer2,
        Z(f64),
    }

    #[derive(Serialize, Deserialize)]
    struct Derived {
        substeps: u32,
        stretch: (u32, f32),
        level: DerivedLevel,
        contacts: Option<(f32, bool)>,
    }

    incise_params::params! {
        /// The same as [`Derived`].
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Own {
            /// Substeps.
            substeps: u32 = 300;
            /// Stretch.
            stretch: Stiffness = Stiffness::Compliance(0.25);
            /// Level.
            level: Level = Level::Z(0.7);
            /// Contacts.
            contacts: Option<Contacts> = Some(Contacts::default());
        }
    }

    #[test]
    fn bytes_are_those_of_derived_implementations() {
        for (level, derived) in [
            (Level::Z(0.7), DerivedLevel::Z(0.7)),
            (Level::Finer2, DerivedLevel::Finer2),
            (Level::Original, DerivedLevel::Original),
        ] {
            let own = Own {
                level,
                ..Own::default()
            };
            let derived = Derived {
                substeps: 300,
                stretch: (1, 0.25),
                level: derived,
                contacts: Some((0.1, false)),
            };
            let bytes = postcard::to_stdvec(&own).unwrap();
            assert_eq!(bytes, postcard::to_stdvec(&derived).unwrap());
            assert_eq!(postcard::from_bytes::<Own>(&bytes).unwrap(), own);
        }
        assert!(
            postcard::from_bytes::<Own>(&[1, 7]).is_err(),
            "no stiffness of this number"
        );
    }

    #[test]
    fn text_formats_have_the_names() {
        let scene = Scene {
            contacts: Some(Contacts::default()),
            ..Scene::default()
        };
        let text = serde_json::to_string(&scene).unwrap();
        assert!(
            text.contains(r#""contacts":{"thickness":0.1,"self_collision":false}"#),
            "{text}"
        );
        assert_eq!(serde_json::from_str::<Scene>(&text).unwrap(), scene);
        let partial: Scene = serde_json::from_str(r#"{"substeps": 3}"#).unwrap();
        assert_eq!(
            partial,
            Scene {
                substeps: 3,
                ..Scene::default()
            }
        );
        for bad in [r#"{"substep": 3}"#, r#"{"dt": -1}"#] {
            assert!(serde_json::from_str::<Scene>(bad).is_err(), "{bad}");
        }
    }
}
