//! Where drawings put what they are given, read off the SVG and the page.

use report::thin::thin;
use report::timing::interval;
use report::{
    Axis, Cell, Contour, Graph, HeatMap, Line, Page, Picture, Readings, Table, TimingDiagram, VectorField,
};

/// Numbers of an attribute of all elements of a kind, in their order.
fn numbers(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
    let value = |tag: &str| tag.split(&format!(" {attribute}=\"")).nth(1)?.split('"').next()?.parse().ok();
    let beginning = format!("<{element} ");
    let tags = svg.split(&beginning).skip(1).filter_map(|rest| rest.split('>').next());
    tags.filter_map(|tag| value(&format!(" {tag}"))).collect()
}

fn svg(graph: &Graph) -> String {
    graph.to_svg().expect("drawn")
}

#[test]
fn law_each_column_of_a_thinned_line_keeps_its_first_lowest_highest_and_last_point() {
    // 256 columns of 1/4 from 64 on; no value comes twice.
    let points: Vec<(f64, f64)> =
        (0..=65_536).map(|i| (64.0 + f64::from(i) / 1024.0, f64::from(i * 7919 % 65_537))).collect();
    let mut expected = Vec::new();
    for column in points.chunks(256) {
        let value = |point: &&(f64, f64)| point.1 as i64;
        let mut keep = vec![
            column[0],
            *column.iter().min_by_key(value).expect("points"),
            *column.iter().max_by_key(value).expect("points"),
            column[column.len() - 1],
        ];
        keep.sort_by(|a, b| a.0.total_cmp(&b.0));
        keep.dedup();
        expected.extend(keep);
    }
    // The right edge belongs to the last column.
    let edge = expected.pop().expect("the edge");
    let last = expected.len() - 1;
    expected[last] = edge;
    let found = thin(&points, 256);
    assert_eq!(found.len(), expected.len());
    assert!(found == expected);
}

#[test]
fn law_lines_that_are_short_or_upright_are_not_thinned() {
    // All but one in the first column.
    let mut crowd: Vec<(f64, f64)> = (0..99).map(|i| (1e-6 * f64::from(i), f64::from(i % 7))).collect();
    crowd.push((1.0, 0.0));
    assert_eq!(thin(&crowd, 25), crowd, "four a column");
    assert!(thin(&crowd, 24).len() < 10, "one more");
    assert_eq!(thin(&crowd, 0), crowd);
    let upright: Vec<(f64, f64)> = (0..1000).map(|i| (3.0, f64::from(i))).collect();
    assert_eq!(thin(&upright, 2), upright);
}

#[test]
fn value_arrows_lie_where_their_axes_put_them() {
    // 448 px from 56 to the right and from 28 down to 476.
    let field = VectorField {
        title: "field".into(),
        x: Axis::over("to the right", -1.0, 1.0),
        y: Axis::over("up", 1.0, 5.0),
        arrows: vec![((0.0, 2.0), (1.0, 2.0)), ((-0.5, 4.0), (-0.5, 4.01)), ((0.5, 3.0), (0.5, 3.0))],
    };
    let svg = field.to_svg().expect("drawn");
    let path = svg.split("<path d=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a path");
    // A barb turns by 0.5 rad (cos 0.8776, sin 0.4794); it is 0.032 long here, and 0.0045 on the short one.
    let expected = [
        "M280.00 364.00L504.00 364.00L497.71 365.72L504.00 364.00L497.71 362.28",
        "M168.00 140.00L168.00 138.88L168.48 139.32L168.00 138.88L167.52 139.32",
        "M392.00 252.00L392.00 252.00",
    ];
    assert_eq!(path, expected.concat());
    assert_eq!(
        numbers(&svg, "text", "x"),
        [280.0, 56.0, 168.0, 280.0, 392.0, 504.0, 50.0, 50.0, 50.0, 50.0, 50.0, 280.0, 14.0]
    );
    assert_eq!(
        numbers(&svg, "text", "y"),
        [18.0, 493.0, 493.0, 493.0, 493.0, 493.0, 480.0, 368.0, 256.0, 144.0, 32.0, 512.0, 252.0]
    );
    for label in [">-1.0<", ">-0.5<", ">0<", ">0.5<", ">1.0<", ">2.0<", ">5.0<", ">to the right<", ">up<"] {
        assert!(svg.contains(label), "{label} in {svg}");
    }
}

#[test]
fn value_normalized_arrows_keep_their_proportions() {
    let axes = || (Axis::over("x", 0.0, 1.0), Axis::over("y", 0.0, 1.0));
    let field =
        VectorField::normalized("f", axes(), 0.1, &[((0.2, 0.3), (3.0, 4.0)), ((0.5, 0.5), (-1.0, 0.0))]);
    // 5 is the longest: 0.085 long.
    let expected = [((0.2, 0.3), (0.251, 0.368)), ((0.5, 0.5), (0.483, 0.5))];
    for (found, expected) in field.arrows.iter().zip(expected) {
        assert_eq!(found.0, expected.0);
        assert!((found.1.0 - expected.1.0).hypot(found.1.1 - expected.1.1) < 1e-12, "{found:?}"); // rounding
    }
    let still = VectorField::normalized("f", axes(), 0.1, &[((0.2, 0.3), (0.0, 0.0))]);
    assert_eq!(still.arrows, [((0.2, 0.3), (0.2, 0.3))], "nothing moves");
}

#[test]
fn value_axes_that_fit_have_a_margin_above_and_below() {
    let graph = |y: Axis, values: [f64; 3]| {
        let points = vec![(0.0, values[0]), (1.0, values[1]), (2.0, values[2])];
        svg(&Graph::new("t", Axis::over("x", 0.0, 2.0), y).with(Line::solid("a", points)))
    };
    let fitted = |values| graph(Axis::fitted("y"), values);
    let over = |values, from, to| graph(Axis::over("y", from, to), values);
    let wide = [100.0, 200.0, 150.0];
    assert_eq!(fitted(wide), over(wide, 94.0, 206.0), "6 % of 100");
    assert_eq!(fitted([4.0; 3]), over([4.0; 3], 2.0, 6.0), "half of it around a constant");
    assert_eq!(fitted([-4.0; 3]), over([-4.0; 3], -6.0, -2.0));
    assert_eq!(fitted([0.0; 3]), over([0.0; 3], -0.5e-3, 0.5e-3), "or of a thousandth");
}

#[test]
fn value_lines_have_their_colours_and_holes() {
    let mut graph = Graph::new("", Axis::over("x", 0.0, 4.0), Axis::over("y", 0.0, 10.0));
    for line in 0..7 {
        let value = f64::from(line);
        let hole = if line % 2 == 0 { (2.0, f64::NAN) } else { (2.0, f64::INFINITY) };
        graph =
            graph.with(Line::solid("", vec![(0.0, value), (1.0, value), hole, (3.0, value), (4.0, value)]));
    }
    let svg = svg(&graph);
    let colours = ["#000000", "#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00"];
    for (at, colour) in colours.into_iter().enumerate() {
        // Both pieces of a line of one look are one path; axes and their marks are black, too.
        let of = |line: &&str| {
            line.contains(colour) && line.starts_with("<path") && line.matches('M').count() == 2
        };
        let count = svg.lines().filter(of).count();
        assert!(if at == 0 { count >= 2 } else { count == 1 }, "{colour}: {count} in {svg}");
    }
}

#[test]
fn value_a_legend_takes_as_many_rows_as_it_needs() {
    let legend = |labels: &[&str]| {
        let mut graph = Graph::new("", Axis::over("x", 0.0, 1.0), Axis::over("y", 0.0, 5.0));
        for label in labels {
            graph = graph.with(Line::solid(*label, vec![(0.0, 0.0), (1.0, 1.0)]));
        }
        let svg = svg(&graph);
        let place = |label: &str| {
            let before = svg.split(&format!("\n{label}\n")).next().expect("the label");
            let tag = before.rsplit("<text ").next().expect("its tag");
            let tag = format!("<text {tag}>");
            (numbers(&tag, "text", "x")[0], numbers(&tag, "text", "y")[0])
        };
        // The upper end of the plot has its label beside it.
        (labels.iter().map(|label| place(label)).collect::<Vec<_>>(), place("5.0").1)
    };
    let long = ["l".repeat(30), "m".repeat(30), "n".repeat(30)];
    let [a, b, c] = [long[0].as_str(), long[1].as_str(), long[2].as_str()];
    let (none, top) = legend(&[]);
    assert!(none.is_empty());
    let (one, top_one) = legend(&[a]);
    // The sample and a gap stand before a text: 26 px.
    assert_eq!(one[0].0, 72.0 + 26.0);
    assert_eq!(top_one - top, 18.0, "a row");
    // 20 + 6 + 30 letters of 6.6 + 18 from one to the next; the third doesn't fit into 640.
    let (three, top_three) = legend(&[a, b, c]);
    assert_eq!(three.iter().map(|place| place.0).collect::<Vec<_>>(), [98.0, 340.0, 98.0]);
    assert_eq!(three[0].1, three[1].1);
    assert_eq!(three[2].1 - three[0].1, 18.0);
    assert_eq!(top_three - top, 36.0, "two rows");
    // One that is longer than the picture has a row of its own, the first one too.
    let endless = "o".repeat(200);
    let (two, _) = legend(&[&endless, "p"]);
    assert_eq!((two[0].0, two[1].0, two[1].1 - two[0].1), (98.0, 98.0, 18.0));
    assert_eq!(two[0].1, one[0].1);
}

#[test]
fn value_cells_are_as_blue_as_their_values() {
    let map = |log_x| HeatMap {
        title: "map".into(),
        x: Axis::over("x", -2.0, 1.0),
        y: Axis::over("y", 0.0, 1.0),
        log_x,
        ticks: Default::default(),
        x_edges: vec![-2.0, -1.0, 0.0, 1.0],
        y_edges: vec![0.0, 1.0],
        values: vec![0.0, 0.5, 1.0],
        contours: vec![Contour { label: "edge".into(), points: vec![(-2.0, 0.0), (1.0, 1.0)] }],
        bar: None,
    };
    let svg = map(true).to_svg().expect("drawn");
    // Three quarters of the way from white to (0, 114, 178) at 1, half of these at 0.5.
    for colour in ["#FFFFFF", "#9FCAE2", "#4095C5"] {
        assert!(
            svg.lines().any(|line| line.starts_with("<rect") && line.contains(colour)),
            "{colour} in {svg}"
        );
    }
    for label in ["\n0.010\n", "\n0.10\n", "\n1.0\n", "\n10\n"] {
        assert!(svg.contains(label), "{label:?} in {svg}");
    }
    assert!(map(false).to_svg().expect("drawn").contains("\n-2.0\n"));
}

/// Cells of a grid reach beyond its values; ticks stand at the values, and thinned where they are many.
#[test]
fn value_ticks_of_a_map_stand_where_they_are_asked_for() {
    let map = |count: u32| {
        let at: Vec<f64> = (0..count).map(|step| f64::from(step) * 20.0).collect();
        let last = at[at.len() - 1];
        let edges = (0..=count).map(|step| f64::from(step) * 20.0 - 10.0).collect();
        let map = HeatMap {
            title: String::new(),
            x: Axis::over("k", -10.0, last + 10.0),
            y: Axis::over("c", -0.75, 2.25),
            log_x: false,
            ticks: [at, vec![0.0, 1.5]],
            x_edges: edges,
            y_edges: vec![-0.75, 0.75, 2.25],
            values: vec![0.5; 2 * count as usize],
            contours: Vec::new(),
            bar: None,
        };
        let svg = map.to_svg().expect("drawn");
        let texts = svg.split("</text>").filter_map(|text| text.trim_end().rsplit('\n').next());
        let mut numbers: Vec<f64> = texts.filter_map(|text| text.trim().parse().ok()).collect();
        numbers.sort_by(f64::total_cmp);
        numbers
    };
    assert_eq!(map(4), [0.0, 0.0, 1.5, 20.0, 40.0, 60.0]);
    assert!(map(40).len() <= 2 + 9, "{:?}", map(40));
}

#[test]
fn value_marks_of_a_picture_lie_beside_it_and_on_it() {
    let marks = vec![("a".to_owned(), 100.0, 50.0), ("b".to_owned(), 30.0, 40.0)];
    let svg = Picture { png: Vec::new(), size: (300, 200), marks }.to_svg();
    // 160 px for each piece, 16 beside the picture, 8 between; the picture is lower than two of them.
    assert!(
        svg.starts_with(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 476 336" width="476" height="336""#
        ),
        "{svg}"
    );
    assert!(svg.contains(r#"<rect x="90.00" y="40.00" width="20" height="20""#));
    assert!(svg.contains(r##"<text x="113.00" y="51.00" fill="#e69f00">a<"##), "{svg}");
    assert!(svg.contains(r#"<svg x="316" y="0" width="160" height="160" viewBox="90.0000 40.0000 20 20""#));
    assert!(svg.contains(r#"<svg x="316" y="168" width="160" height="160" viewBox="20.0000 30.0000 20 20""#));
    assert!(svg.contains("M98.0000 50.0000H102.0000M100.0000 48.0000V52.0000"));
    assert!(svg.contains(r##"<text x="320" y="14" fill="#e69f00">a<"##));
    assert!(svg.contains(r##"<text x="320" y="182" fill="#e69f00">b<"##));
    let bare = Picture { png: Vec::new(), size: (300, 200), marks: Vec::new() }.to_svg();
    assert!(bare.contains(r#"viewBox="0 0 300 200""#));
}

#[test]
fn value_a_timing_diagram_from_the_second_second() {
    let lanes = (0..7).map(|lane| (format!("unit{lane}"), 0.05, vec![1.0, 1.05, 1.1]));
    let arrows = vec![((1, 1.0), (0, 1.05)), ((6, 1.05), (5, 1.1))];
    let diagram = TimingDiagram::of((1.0, 1.1), lanes.collect(), arrows.into_iter()).expect("seven lanes");
    let svg = diagram.to_svg();
    // 20 above, 46 a lane, 40 below less half a lane.
    assert!(svg.contains(r#"viewBox="0 0 640 359" width="640" height="359""#), "{svg}");
    // Five letters take 35 after 16; the end lies 24 before the edge: 565 px for a tenth of a second.
    assert!(svg.contains(r##"x1="51.00" x2="616.00" y1="20" y2="20" stroke="#888""##), "{svg}");
    assert!(svg.contains(r##"x1="333.50" x2="333.50" y1="291" y2="301" stroke="#222""##), "{svg}");
    assert!(svg.contains(r#"x1="51.00" y1="66" x2="333.50" y2="20""#), "{svg}");
    // Six colours: the seventh lane has the first one's.
    assert!(svg.contains(r##"x1="333.50" y1="296" x2="616.00" y2="250" stroke="#1f5fa8""##), "{svg}");
    assert!(svg.contains(r##"stroke="#b3541e""##));
    // Ticks go down to the last lane's lower edge and have their labels below it.
    assert!(svg.contains(r##"<line x1="51.00" x2="51.00" y1="10" y2="319" stroke="#e4e4e4""##), "{svg}");
    assert!(svg.contains(r#"<text x="51.00" y="333" text-anchor="middle">1.00<"#), "{svg}");
    assert!(svg.contains(r#"<text x="616.00" y="333" text-anchor="middle">1.10<"#), "{svg}");
    let moment = TimingDiagram { span: (1.0, 1.0), lanes: vec![("a".into(), vec![1.0])], arrows: Vec::new() };
    assert!(!moment.to_svg().contains("NaN"));
}

#[test]
fn value_units_without_points_tell_their_intervals() {
    let of = |count: usize, points: &[f64]| {
        let lanes = (0..count).map(|lane| (format!("u{lane}"), 0.0025, points.to_vec())).collect();
        TimingDiagram::of((0.0, 1.0), lanes, std::iter::empty())
    };
    assert!(of(0, &[]).is_none() && of(25, &[]).is_none());
    assert_eq!(of(24, &[]).expect("room").lanes.len(), 24);
    assert_eq!(of(1, &[]).expect("room").lanes[0].0, "u0, each 2.5000 ms");
    assert_eq!(of(1, &[0.5]).expect("room").lanes[0].0, "u0");
    let said =
        [(2.0, "2 s"), (1.0, "1 s"), (0.005, "5 ms"), (1e-3, "1 ms"), (2e-6, "2 µs"), (1.25e-4, "125 µs")];
    for (seconds, text) in said {
        assert_eq!(interval(seconds), text);
    }
}

#[test]
fn law_a_page_has_the_scripts_that_it_needs_and_no_others() {
    let mut plain = Page::new("plain");
    plain.text("words").table(&Table { head: vec!["a".into()], rows: vec![vec![Cell::Text("b".into())]] });
    assert!(!plain.to_html().contains("<script"));
    // A column or a graph alone needs them.
    let mut column = Page::new("column");
    assert_eq!(column.column(&[1.0, 2.0]).expect("packed"), 0);
    assert_eq!(column.column(&[1.0, 3.0]).expect("packed"), 1);
    assert_eq!(column.column(&[1.0, 2.0]).expect("packed"), 0, "known");
    assert!(column.to_html().contains("<script"));
    // Two maps share theirs.
    let map = HeatMap {
        title: "m".into(),
        x: Axis::over("x", 0.0, 1.0),
        y: Axis::over("y", 0.0, 1.0),
        log_x: false,
        ticks: Default::default(),
        x_edges: vec![0.0, 1.0],
        y_edges: vec![0.0, 1.0],
        values: vec![0.5],
        contours: Vec::new(),
        bar: None,
    };
    let count = |maps: u32| {
        let mut page = Page::new("maps");
        for _ in 0..maps {
            let place = page.map(&map, &Readings::default(), "a `map`").expect("drawn");
            page.push(place);
        }
        let html = page.to_html();
        assert_eq!(html.matches("aria-label=\"a map\"").count(), maps as usize, "for those who can't see it");
        html.matches("<script").count()
    };
    assert!(count(1) > 0);
    assert_eq!(count(2), count(1));
}

#[test]
fn value_graphs_of_a_page_count_from_0_and_pictures_have_names() {
    let graph = |points| {
        Graph::new("t", Axis::over("x", 0.0, 2.0), Axis::over("y", 0.0, 2.0)).with(Line::solid("a", points))
    };
    let mut page = Page::new("graphs");
    let places = [vec![(0.0, 1.0), (1.0, 2.0)], vec![(0.0, 1.0), (2.0, 2.0)]]
        .map(|points| page.place(&graph(points), "").expect("drawn").into_string());
    assert!(places[0].contains("data-graph=\"0\"") && places[1].contains("data-graph=\"1\""));
    // A line that stands still or goes back in x, and a single point, stay pictures.
    for points in [vec![(0.0, 1.0), (0.0, 2.0), (1.0, 1.0)], vec![(1.0, 1.0), (0.0, 2.0)], vec![(1.0, 1.0)]] {
        let place = page.place(&graph(points), "its `name`").expect("drawn").into_string();
        assert!(!place.contains("data-graph"), "{place}");
        assert!(place.contains("<svg role=\"img\" aria-label=\"its name\" "), "{place}");
    }
}

/// An error tells the last calls of a unit below what it did.
#[test]
fn value_the_lines_of_a_note_stay_lines() {
    let verdict = report::Verdict {
        standing: report::Standing::Bad,
        words: "ended by an error".into(),
        figures: Vec::new(),
        notes: vec!["a segmentation fault)\n  last calls: fmi2GetReal".into()],
    };
    let page = report::Page::new("x").verdict(&verdict).to_html();
    assert!(page.contains("a segmentation fault)<br>  last calls: fmi2GetReal"), "{page}");
}
