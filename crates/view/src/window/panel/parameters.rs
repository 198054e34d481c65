//! Controls of the parameters of a struct, made from its table of fields.

use egui::{ComboBox, DragValue, Slider, Ui};
use incise_params::{Field, Kind, Params, Range, Value};

/// Ratio of the bounds above which a slider is logarithmic.
///
/// A linear slider of 200 pixels would have its two lowest decades in two of them.
const LOGARITHMIC: f64 = 1000.0;

/// Draws a control per parameter outside `skip`, and applies changes within their ranges.
pub(super) fn show<P: Params + Clone>(ui: &mut Ui, params: &mut P, prefix: &str, skip: &[&str]) {
    let mut controls = Controls {
        params: params.clone(),
        skip,
    };
    let fields = incise_params::all_fields(P::FIELDS);
    let fields = match fields.iter().find(|(path, _)| path == prefix) {
        Some((_, field)) => field.kind.fields().unwrap_or_default(),
        None => P::FIELDS,
    };
    controls.fields(ui, prefix, fields);
    if controls.params.check_ranges().is_ok() {
        *params = controls.params;
    }
}

/// The parameters while their controls are drawn.
struct Controls<'a, P> {
    params: P,
    /// Dotted names without a control.
    skip: &'a [&'a str],
}

impl<P: Params + Clone> Controls<'_, P> {
    fn fields(&mut self, ui: &mut Ui, prefix: &str, fields: &'static [Field]) {
        for field in fields {
            let path = match prefix {
                "" => field.name.to_owned(),
                prefix => format!("{prefix}.{}", field.name),
            };
            if !self.skip.contains(&path.as_str()) {
                self.field(ui, &path, field);
            }
        }
    }

    fn field(&mut self, ui: &mut Ui, path: &str, field: &Field) {
        let value = self.params.get(path).unwrap_or(Value::None);
        let is_on = !matches!(value, Value::None);
        match field.kind {
            Kind::Struct(fields) => self.fields(ui, path, fields),
            Kind::Optional(Kind::Struct(fields)) => {
                let mut now = is_on;
                label(ui.checkbox(&mut now, title(field.name)), field);
                self.set_if(now != is_on, path, Value::Flag(now));
                if now {
                    ui.indent(path, |ui| self.fields(ui, path, fields));
                }
            }
            Kind::Optional(inner) => {
                ui.horizontal(|ui| {
                    let mut now = is_on;
                    label(ui.checkbox(&mut now, ""), field);
                    let shown = match (is_on, now) {
                        (true, _) => value,
                        (false, true) => initial(inner, field.range),
                        (false, false) => Value::None,
                    };
                    let new = if now { shown.clone() } else { Value::None };
                    self.set_if(now != is_on, path, new);
                    match now {
                        true => self.control(ui, path, field, inner, &shown),
                        false => drop(ui.label(title(field.name))),
                    }
                });
            }
            ref kind => self.control(ui, path, field, kind, &value),
        }
    }

    /// Draws the control of a value.
    fn control(&mut self, ui: &mut Ui, path: &str, field: &Field, kind: &Kind, value: &Value) {
        match kind {
            Kind::Flag => {
                let mut now = *value == Value::Flag(true);
                let response = label(ui.checkbox(&mut now, title(field.name)), field);
                self.set_if(response.changed(), path, Value::Flag(now));
            }
            Kind::Number | Kind::Count => self.number(ui, path, field, kind, value),
            Kind::List(..) => self.list(ui, path, field, value),
            Kind::Choice(names) => {
                let new = choose(ui, path, field, &value.to_string(), names.iter().copied());
                self.set_if(new.is_some(), path, new.map_or(Value::None, Value::from));
            }
            Kind::Variants(variants) => self.variants(ui, path, field, variants, value),
            _ => {}
        }
    }

    fn number(&mut self, ui: &mut Ui, path: &str, field: &Field, kind: &Kind, value: &Value) {
        let Some(mut number) = value.number() else {
            return;
        };
        let Range { min, max, .. } = field.range;
        let is_whole = matches!(kind, Kind::Count);
        let min = if is_whole { min.max(0.0) } else { min };
        let text = title(field.name);
        let response = if min.is_finite() && max.is_finite() {
            let slider = Slider::new(&mut number, min..=max).text(text);
            let slider = slider.logarithmic(max > LOGARITHMIC * min.max(1.0));
            ui.add(if is_whole { slider.integer() } else { slider })
        } else {
            let speed = if is_whole {
                0.1
            } else {
                0.01 * number.abs().max(0.01)
            };
            let drag = DragValue::new(&mut number).range(min..=max).speed(speed);
            let drag = if is_whole { drag.max_decimals(0) } else { drag };
            ui.horizontal(|ui| {
                let response = ui.add(drag);
                ui.label(text);
                response
            })
            .inner
        };
        let response = label(response, field);
        self.set_if(response.changed(), path, Value::Number(number));
    }

    fn list(&mut self, ui: &mut Ui, path: &str, field: &Field, value: &Value) {
        let Value::List(values) = value else { return };
        let mut numbers: Vec<f64> = values.iter().filter_map(Value::number).collect();
        ui.horizontal(|ui| {
            let mut has_changed = false;
            for number in &mut numbers {
                has_changed |= ui.add(DragValue::new(number).speed(0.1)).changed();
            }
            label(ui.label(title(field.name)), field);
            let list = Value::List(numbers.iter().copied().map(Value::Number).collect());
            self.set_if(has_changed, path, list);
        });
    }

    fn variants(
        &mut self,
        ui: &mut Ui,
        path: &str,
        field: &Field,
        variants: &'static [Field],
        value: &Value,
    ) {
        let present = match value {
            Value::Map(entries) => entries.first().map(|(name, _)| name.clone()),
            value => Some(value.to_string()),
        };
        let present = present.unwrap_or_default();
        let names = variants.iter().map(|variant| variant.name);
        if let Some(name) = choose(ui, path, field, &present, names) {
            let chosen = variants.iter().find(|variant| variant.name == name);
            let kind = chosen.map_or(Kind::Unit, |variant| variant.kind);
            let number = initial(&kind, chosen.map_or(Range::FINITE, |variant| variant.range));
            let new = match kind {
                Kind::Number => Value::Map(vec![(name.to_owned(), number)]),
                _ => Value::from(name),
            };
            self.set_if(true, path, new);
        }
        if let Some(variant) = variants.iter().find(|variant| variant.name == present) {
            let inner = format!("{path}.{}", variant.name);
            if let (Kind::Number, Value::Map(entries)) = (&variant.kind, value) {
                let number = entries
                    .first()
                    .map_or(Value::None, |(_, number)| number.clone());
                self.number(ui, &inner, variant, &Kind::Number, &number);
            }
        }
    }

    fn set_if(&mut self, has_changed: bool, path: &str, value: Value) {
        if has_changed {
            // A value of a control has the type of its field.
            let _ = self.params.set(path, &value);
        }
    }
}

/// Returns the first value of a parameter that is switched on.
fn initial(kind: &Kind, range: Range) -> Value {
    match kind {
        Kind::Variants([first, ..]) => Value::Map(vec![(
            first.name.to_owned(),
            initial(&first.kind, first.range),
        )]),
        Kind::Number if range == Range::FRACTION => Value::Number(range.max),
        Kind::Number if range.contains(0.0) => Value::Number(0.0),
        Kind::Number => Value::Number(1.0),
        Kind::Count => Value::Count(1),
        _ => Value::None,
    }
}

/// Draws a list of names and returns the one that is chosen now.
fn choose<'a>(
    ui: &mut Ui,
    path: &str,
    field: &Field,
    present: &str,
    names: impl Iterator<Item = &'a str>,
) -> Option<&'a str> {
    let list = ComboBox::new(path, title(field.name)).selected_text(present.to_owned());
    let list = list.show_ui(ui, |ui| {
        let mut chosen = None;
        for name in names {
            if ui.selectable_label(name == present, name).clicked() && name != present {
                chosen = Some(name);
            }
        }
        chosen
    });
    label(list.response, field);
    list.inner.flatten()
}

/// Returns the name of a parameter for the panel.
fn title(name: &str) -> String {
    name.replace('_', " ")
}

/// Explains a control by unit and documentation of its parameter; units are too long for the panel.
fn label(response: egui::Response, field: &Field) -> egui::Response {
    response.on_hover_text(match field.unit {
        "" => field.summary(),
        unit => format!("[{unit}] {}", field.summary()),
    })
}
