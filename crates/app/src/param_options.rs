//! [`ParamOptions`]: options of the command line for the parameters of a library.

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use incise_params::{
    Field, Kind, ParamError, Parameter, Params, Range, Value, all_fields, short_name,
};
use std::marker::PhantomData;

/// A choice of parameters for options.
pub(crate) trait OptionSet {
    /// The parameters.
    type Params: Params + Clone + 'static;

    /// Returns the defaults of the command.
    fn defaults() -> Self::Params {
        Self::Params::default()
    }

    /// Completes the option of a parameter; none to leave it out.
    fn option(path: &str, option: Arg) -> Option<Arg>;
}

/// The parameters that a command line gives, each by an option of its short name.
#[derive(Debug)]
pub(crate) struct ParamOptions<S> {
    given: Vec<(String, Value)>,
    set: PhantomData<S>,
}

impl<S: OptionSet> ParamOptions<S> {
    /// Returns the parameters that are given, by name.
    pub(crate) fn given(&self) -> &[(String, Value)] {
        &self.given
    }

    /// Returns the first option that is given.
    pub(crate) fn first_option(&self) -> Option<String> {
        let (name, _) = self.given.first()?;
        Some(format!("--{name}"))
    }

    /// Returns the defaults with the parameters that are given.
    pub(crate) fn params(&self) -> Result<S::Params, ParamError> {
        let mut params = S::defaults();
        params.set_value(&Value::Map(self.given.clone()))?;
        Ok(params)
    }
}

/// Returns the parameters that have a value of their own, with dotted and short name.
fn parameters<P: Params>() -> impl Iterator<Item = (String, String, &'static Field)> {
    let all = all_fields(P::FIELDS).into_iter();
    all.filter(|(_, field)| !matches!(field.kind, Kind::Struct(_)))
        .map(|(path, field)| {
            let short = short_name(P::FIELDS, &path);
            (path, short, field)
        })
}

/// Returns the name of an option.
fn option_name(short: &str) -> String {
    short.replace(['.', '_'], "-")
}

impl<S: OptionSet> Args for ParamOptions<S> {
    fn augment_args(command: Command) -> Command {
        let defaults = S::defaults().value();
        let options = parameters::<S::Params>().filter_map(|(path, short, field)| {
            let name = option_name(&short);
            let parse = move |text: &str| parse::<S::Params>(&short, text);
            let option = Arg::new(name.clone())
                .long(name)
                .value_name(value_name(field))
                .help(help(
                    field,
                    defaults.at(&path).unwrap_or_else(field.default),
                ))
                .value_parser(parse)
                .allow_hyphen_values(true);
            let option = match field.kind.inner() {
                // `--fair` is `--fair=true`.
                Kind::Flag | Kind::Struct(_) => option
                    .num_args(0..=1)
                    .require_equals(true)
                    .default_missing_value("true"),
                _ => option,
            };
            S::option(&path, option)
        });
        command.args(options.collect::<Vec<_>>())
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<S: OptionSet> FromArgMatches for ParamOptions<S> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = parameters::<S::Params>().filter_map(|(_, short, _)| {
            let name = option_name(&short);
            let value = matches.try_get_one::<Value>(&name).ok()??;
            Some((name, value.clone()))
        });
        Ok(Self {
            given: given.collect(),
            set: PhantomData,
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Parses the value of an option, which must be in its range.
fn parse<P: Params + Clone>(name: &str, text: &str) -> Result<Value, ParamError> {
    let value = Value::parse(text);
    let mut params = P::default();
    params.set(name, &value)?;
    params.check_ranges()?;
    Ok(value)
}

/// Returns the placeholder of a value.
fn value_name(field: &Field) -> String {
    match *field.kind.inner() {
        Kind::Flag | Kind::Struct(_) => "true|false".to_owned(),
        Kind::Count => "N".to_owned(),
        Kind::List(3, _) => "X,Y,Z".to_owned(),
        Kind::Choice(names) => names.join("|"),
        Kind::Variants(variants) if variants.iter().any(|v| matches!(v.kind, Kind::Number)) => {
            "NAME|NUMBER".to_owned()
        }
        Kind::Variants(variants) => {
            let names: Vec<&str> = variants.iter().map(|variant| variant.name).collect();
            names.join("|")
        }
        _ => "NUMBER".to_owned(),
    }
}

/// Returns the help of a parameter: its summary, unit, names and default.
fn help(field: &Field, default: Value) -> String {
    let mut help = field.summary();
    if let Kind::Variants(variants) = *field.kind.inner() {
        let names = variants.iter().filter(|v| matches!(v.kind, Kind::Unit));
        let names: Vec<&str> = names.map(|variant| variant.name).collect();
        help += &match names.len() == variants.len() {
            true => format!(" One of {}.", names.join(", ")),
            false => format!(" One of {}, or a number.", names.join(", ")),
        };
    }
    if matches!(field.kind.inner(), Kind::Number | Kind::Count) && field.range != Range::FINITE {
        let range = field.range.to_string();
        let range = range.replace("a finite number ", "").replace("of at", "at");
        help += &format!(" Range: {range}.");
    }
    if !field.unit.is_empty() {
        help += &format!(" [{}]", field.unit);
    }
    match default {
        Value::Count(u64::MAX) => help + " [default: no limit]",
        Value::Map(entries) => match (field.kind, entries.as_slice()) {
            (Kind::Variants(_), [(name, _)]) => help + &format!(" [default: {name}]"),
            _ => help + " [default: true]",
        },
        default => help + &format!(" [default: {default}]"),
    }
}
