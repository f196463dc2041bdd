#include "patina/pipeline/plan_lamps.h"

namespace patina {
namespace {

OptionTable input_options(PlanOptions& options) {
    return {
        with_letter(path_option("output",
                                "DIR",
                                options.output,
                                "write rig.json and chosen.lp of the chosen lamps, and plan.html"),
                    "o"),
        path_option("given",
                    "CAPTURE",
                    options.given,
                    "shots of the same object that were taken already: which look would add most"),
        path_option(
            "maps", "RESULT", options.maps, "plan for these maps instead of a typical surface"),
        text_option("taken",
                    "ID,ID",
                    options.taken,
                    "lamps that were shot already: they count and are not chosen again"),
    };
}

OptionTable choice_options(StudyOptions& study) {
    return {
        choice_option("rule", study.rule, plan_rules(), "what makes a lamp worth taking"),
        integer_option("lamps",
                       study.max_lamps,
                       between(0, 100000),
                       "choose so many; 0: as many as the rule finds worth it"),
        number_option("min_drop",
                      study.min_drop,
                      between(0, 0.99),
                      "",
                      "rule d-optimal: stop when a lamp lowers the standard errors by less"),
        number_option("prior_diffuse", study.prior_diffuse, above(0), "", "typical Pd"),
        number_option("prior_specular_albedo",
                      study.prior_specular_albedo,
                      above(0),
                      "",
                      "typical 2 sigma^2 Ps, reflectance at normal incidence"),
        integer_option("plan_texels",
                       study.max_texels,
                       between(0, 1 << 30),
                       "texels that information is summed over; 0: all that are seen"),
        integer_option("draws",
                       study.num_draws,
                       between(1, 1000),
                       "random choices that the rules are compared with"),
        integer_option(
            "next_looks", study.num_next, between(0, 100000), "with --given: single looks to rank"),
    };
}

OptionTable stand_options(LampStandOptions& stand) {
    return {
        integer_option("dome",
                       stand.dome,
                       between(0, 100000),
                       "candidates on a dome, instead of the lamps of PATH; 0: no dome"),
        size_option("grid",
                    stand.grid_across,
                    stand.grid_along,
                    "1 or more each",
                    "candidates on a flat grid, instead of the lamps of PATH"),
        number_option("radius",
                      stand.radius,
                      above(0),
                      "of the length unit",
                      "distance of the cameras",
                      "radius of the dome, or distance of the grid"),
        number_option("spacing",
                      stand.spacing,
                      above(0),
                      "of the length unit",
                      "a tenth of the radius",
                      "between the lamps of the grid"),
        vector_option("center", stand.center, "middle of the geometry", "of the dome"),
        vector_option("axis",
                      stand.axis,
                      "towards the cameras",
                      "from the centre to the middle of the candidates"),
    };
}

OptionTable cover_options(CoverOptions& cover) {
    return {
        number_option("roughness",
                      cover.roughness,
                      above(0),
                      "rad",
                      "sigma that is expected of the surface; half and twice as much count too"),
        number_option("specular_reach",
                      cover.specular_reach,
                      above(0),
                      "",
                      "theta_r below this many sigma shows the highlight"),
        number_option("diffuse_reach",
                      cover.diffuse_reach,
                      above(0),
                      "",
                      "theta_r above this many sigma shows none"),
        integer_option("specular_need",
                       cover.specular_need,
                       between(1, 255),
                       "lamps that must show a texel's highlight"),
        integer_option("diffuse_need",
                       cover.diffuse_need,
                       between(1, 255),
                       "lamps that must show a texel without highlight"),
        number_option("min_gain",
                      cover.min_gain,
                      at_least(0),
                      "",
                      "rule paper: stop when a lamp adds less, as a share of the seen texels"),
        number_option("enough",
                      cover.enough,
                      Range{0, 1, true},
                      "",
                      "rule paper: stop at this share of what all candidates can measure"),
        angle_option("max_light_angle",
                     cover.max_light_angle,
                     between(1, 90),
                     "leave out light further from the normal"),
        angle_option("max_view_angle",
                     cover.max_view_angle,
                     between(1, 90),
                     "leave out views further from the normal"),
    };
}

}  // namespace

const Choices<PlanRule>& plan_rules() {
    static const Choices<PlanRule> rules = {{"d-optimal", PlanRule::d_optimal},
                                            {"paper", PlanRule::paper}};
    return rules;
}

OptionTable plan_option_table(PlanOptions& options) {
    OptionTable table = input_options(options);
    for (const OptionTable& part : {choice_options(options.study),
                                    stand_options(options.stand),
                                    cover_options(options.study.cover)}) {
        table.insert(table.end(), part.begin(), part.end());
    }
    return table;
}

}  // namespace patina
