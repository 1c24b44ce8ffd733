//! How QGIS shows the layers: its own style documents (QML), one a layer.

use super::measure::LengthOutput;
use crate::io::vector::Style;
use std::fmt::Write;

const HEAD: &str = "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n";

/// Classes of prominence: least value in metres, symbol size in millimetres, colour.
const PEAK_CLASSES: [(f64, f64, &str); 6] = [
    (0.0, 1.4, "166,148,128,255"),
    (100.0, 1.9, "160,118,74,255"),
    (200.0, 2.4, "158,90,38,255"),
    (400.0, 3.0, "146,56,20,255"),
    (800.0, 3.8, "120,22,12,255"),
    (1500.0, 4.8, "78,4,10,255"),
];

/// Classes of the prominence of ridges: least value in metres, width in millimetres.
const RIDGE_CLASSES: [(f64, f64); 5] = [(0.0, 0.16), (100.0, 0.3), (200.0, 0.5), (400.0, 0.75), (800.0, 1.1)];

/// Colours of triangles, from the lowest ground to the highest.
const HEIGHT_COLOURS: [&str; 7] = [
    "112,148,112,255",
    "152,176,122,255",
    "196,200,142,255",
    "214,190,140,255",
    "192,156,116,255",
    "166,132,112,255",
    "226,222,218,255",
];

fn options(options: &[(&str, &str)]) -> String {
    let mut text = String::from("<Option type=\"Map\">");
    for (name, value) in options {
        let _ = write!(text, "<Option type=\"QString\" name=\"{name}\" value=\"{value}\"/>");
    }
    text + "</Option>"
}

fn marker(name: &str, shape: &str, size: f64, fill: &str, outline: &str) -> String {
    let size = size.to_string();
    let options = options(&[
        ("name", shape),
        ("color", fill),
        ("outline_color", outline),
        ("outline_width", "0.2"),
        ("outline_width_unit", "MM"),
        ("size", &size),
        ("size_unit", "MM"),
        ("angle", "0"),
    ]);
    format!(
        "<symbol type=\"marker\" name=\"{name}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">\
         <layer class=\"SimpleMarker\" enabled=\"1\" locked=\"0\" pass=\"0\">{options}</layer></symbol>"
    )
}

fn line(name: &str, width: f64, colour: &str, dash: &str) -> String {
    let width = width.to_string();
    let options = options(&[
        ("line_color", colour),
        ("line_width", &width),
        ("line_width_unit", "MM"),
        ("line_style", dash),
        ("capstyle", "round"),
        ("joinstyle", "round"),
    ]);
    format!(
        "<symbol type=\"line\" name=\"{name}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">\
         <layer class=\"SimpleLine\" enabled=\"1\" locked=\"0\" pass=\"0\">{options}</layer></symbol>"
    )
}

/// A renderer that chooses the symbol by the class of a number.
fn graduated(attribute: &str, unit: LengthOutput, bounds: &[f64], symbols: &str) -> String {
    let mut ranges = String::new();
    for (i, &low) in bounds.iter().enumerate() {
        let high = bounds.get(i + 1).copied();
        let label = match high {
            Some(high) => format!("{} \u{2013} {} {}", unit.of(low).round(), unit.of(high).round(), unit.suffix()),
            None => format!("\u{2265} {} {}", unit.of(low).round(), unit.suffix()),
        };
        let _ = write!(
            ranges,
            "<range lower=\"{}\" upper=\"{}\" symbol=\"{i}\" label=\"{label}\" render=\"true\"/>",
            // Roots below sea level and base levels may have less than the first bound.
            if i == 0 { -1e6 } else { unit.of(low) },
            high.map_or(1e6, |high| unit.of(high)),
        );
    }
    format!(
        "<renderer-v2 type=\"graduatedSymbol\" attr=\"{attribute}\" graduatedMethod=\"GraduatedColor\" \
         symbollevels=\"0\" enableorderby=\"1\" forceraster=\"0\"><ranges>{ranges}</ranges><symbols>{symbols}</symbols>\
         <orderby><orderByClause asc=\"1\" nullsFirst=\"1\">\"{attribute}\"</orderByClause></orderby></renderer-v2>"
    )
}

fn document(categories: &str, body: &str) -> String {
    format!("{HEAD}<qgis version=\"3.22.0\" styleCategories=\"{categories}\">{body}</qgis>\n")
}

/// Peaks: triangles by prominence, with name and elevation; the smaller the scale, the fewer labels.
pub(super) fn peaks(unit: LengthOutput) -> Style {
    let suffix = unit.suffix();
    let mut symbols = String::new();
    for (i, (_, size, colour)) in PEAK_CLASSES.iter().enumerate() {
        symbols += &marker(&i.to_string(), "triangle", *size, colour, "255,255,255,255");
    }
    let bounds: Vec<f64> = PEAK_CLASSES.iter().map(|class| class.0).collect();
    let renderer = graduated(&format!("prominence_{suffix}"), unit, &bounds, &symbols);
    // At 1:24,000 peaks of 30 m and more are labelled, at 1:400,000 those of 500 m.
    let scale = 800.0 / unit.of(1.0);
    let text =
        format!("coalesce(&quot;name&quot; || '\\n', '') || format_number(round(&quot;elevation_{suffix}&quot;), 0)");
    let labels = format!(
        "<labeling type=\"simple\"><settings calloutType=\"simple\">\
         <text-style fieldName=\"{text}\" isExpression=\"1\" fontFamily=\"Sans Serif\" fontSize=\"8\" fontSizeUnit=\"Point\" \
         textColor=\"60,30,16,255\" namedStyle=\"Regular\" fontWeight=\"50\" fontItalic=\"0\" textOpacity=\"1\" \
         multilineHeight=\"0.9\"><text-buffer bufferDraw=\"1\" bufferSize=\"0.8\" bufferSizeUnits=\"MM\" \
         bufferColor=\"255,255,255,220\" bufferOpacity=\"1\" bufferJoinStyle=\"128\" bufferNoFill=\"1\"/></text-style>\
         <placement placement=\"6\" dist=\"0.6\" distUnits=\"MM\" priority=\"5\" offsetType=\"1\" \
         predefinedPositionOrder=\"TR,TL,BR,BL,R,L,TSR,BSR\"/>\
         <rendering obstacle=\"1\" obstacleFactor=\"0.6\" displayAll=\"0\" drawLabels=\"1\" scaleVisibility=\"0\"/>\
         <dd_properties><Option type=\"Map\"><Option type=\"QString\" name=\"name\" value=\"\"/>\
         <Option type=\"Map\" name=\"properties\">\
         <Option type=\"Map\" name=\"Show\"><Option type=\"bool\" name=\"active\" value=\"true\"/>\
         <Option type=\"QString\" name=\"expression\" value=\"&quot;prominence_{suffix}&quot; * {scale} &gt;= @map_scale\"/>\
         <Option type=\"int\" name=\"type\" value=\"3\"/></Option>\
         <Option type=\"Map\" name=\"Priority\"><Option type=\"bool\" name=\"active\" value=\"true\"/>\
         <Option type=\"QString\" name=\"expression\" value=\"min(10, &quot;prominence_{suffix}&quot; / {step})\"/>\
         <Option type=\"int\" name=\"type\" value=\"3\"/></Option></Option>\
         <Option type=\"QString\" name=\"type\" value=\"collection\"/></Option></dd_properties></settings></labeling>",
        step = unit.of(150.0),
    );
    let body = format!("{renderer}{labels}");
    Style { name: "peaks by prominence".into(), qml: document("Symbology|Labeling", &body) }
}

/// Saddles: small crosses that do not shout.
pub(super) fn saddles() -> Style {
    let symbol = marker("0", "cross2", 1.1, "52,86,120,255", "52,86,120,255");
    let body = format!(
        "<renderer-v2 type=\"singleSymbol\" symbollevels=\"0\" enableorderby=\"0\" forceraster=\"0\">\
         <symbols>{symbol}</symbols></renderer-v2>"
    );
    Style { name: "key saddles".into(), qml: document("Symbology", &body) }
}

/// Divides: the wider, the more prominent the peak that ends at their saddle.
pub(super) fn divide_tree(unit: LengthOutput) -> Style {
    let mut symbols = String::new();
    for (i, (_, width)) in RIDGE_CLASSES.iter().enumerate() {
        symbols += &line(&i.to_string(), *width, "92,52,28,225", "solid");
    }
    let bounds: Vec<f64> = RIDGE_CLASSES.iter().map(|class| class.0).collect();
    let body = graduated(&format!("prominence_{}", unit.suffix()), unit, &bounds, &symbols);
    Style { name: "divide tree by prominence".into(), qml: document("Symbology", &body) }
}

/// Isolation: fine dashes.
pub(super) fn isolation() -> Style {
    let symbol = line("0", 0.18, "40,90,140,150", "dash");
    let body = format!(
        "<renderer-v2 type=\"singleSymbol\" symbollevels=\"0\" enableorderby=\"0\" forceraster=\"0\">\
         <symbols>{symbol}</symbols></renderer-v2>"
    );
    Style { name: "isolation".into(), qml: document("Symbology", &body) }
}

/// Triangles: tinted by elevation, with fine outlines.
pub(super) fn triangles((low_m, high_m): (f64, f64)) -> Style {
    let mut symbols = String::new();
    for (i, colour) in HEIGHT_COLOURS.iter().enumerate() {
        let options = options(&[
            ("color", colour),
            ("style", "solid"),
            ("outline_color", "70,60,50,130"),
            ("outline_style", "solid"),
            ("outline_width", "0.06"),
            ("outline_width_unit", "MM"),
        ]);
        let _ = write!(
            symbols,
            "<symbol type=\"fill\" name=\"{i}\" alpha=\"1\" clip_to_extent=\"1\" force_rhr=\"0\">\
             <layer class=\"SimpleFill\" enabled=\"1\" locked=\"0\" pass=\"0\">{options}</layer></symbol>"
        );
    }
    let step_m = (high_m - low_m) / HEIGHT_COLOURS.len() as f64;
    let bounds: Vec<f64> = (0..HEIGHT_COLOURS.len()).map(|i| low_m + step_m * i as f64).collect();
    let body = graduated("elevation_m", LengthOutput::Metres, &bounds, &symbols);
    Style { name: "triangles by elevation".into(), qml: document("Symbology", &body) }
}
