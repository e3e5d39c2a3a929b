//! What both sheets and single fibres warn of: pulps that contradict themselves.
use loadframe_api::spec::paper_tensile::PaperTensile;
use loadframe_harness::ReportBuilder;

/// Warns of pulps whose coarseness and wall contradict one another.
pub(super) fn warn_of_contradictions(report: &mut ReportBuilder, spec: &PaperTensile) {
    let contradicted = spec.pulp.iter().filter_map(|pulp| {
        let (section, coarseness) = pulp.section().ok().zip(pulp.coarseness_mg_per_m)?;
        Some((&pulp.name, section.contradiction(coarseness)?))
    });
    for (name, contradiction) in contradicted {
        let detail = format!("pulp {name:?}: {contradiction}");
        report.warn("contradicting_coarseness", detail);
    }
}
