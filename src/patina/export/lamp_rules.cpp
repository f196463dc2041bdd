#include "patina/export/lamp_rules.h"

#include "patina/export/html_page.h"
#include "patina/export/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>

namespace patina {
namespace {

// Three beside each other on the page [pixels].
constexpr double kWidth = 345;
constexpr double kHeight = 270;

// One share of every rule over the number of lamps.
Plot rule_plot(const std::vector<LampRule>& rules,
               std::size_t num_chosen,
               const char* title,
               std::vector<double> LampRule::*share) {
    Plot plot;
    plot.title = title;
    plot.x_axis = {"lamps besides those taken"};
    plot.y_axis = {"share of the seen texels [%]", AxisScale::linear, 0, 100};
    for (const LampRule& rule : rules) {
        PlotSeries series;
        series.label = rule.rule;
        for (std::size_t n = 0; n < (rule.*share).size(); ++n) {
            series.x.push_back(double(n));
            series.y.push_back(100 * (rule.*share)[n]);
        }
        series.color = int(plot.series.size()) + 1;
        series.is_dashed = rule.rule == "random" || rule.rule == "uniform";
        plot.series.push_back(std::move(series));
    }
    plot.width = kWidth;
    plot.height = kHeight;
    plot.marks = {{double(num_chosen), "chosen"}};
    return plot;
}

}  // namespace

std::string lamp_rule_charts(const std::vector<LampRule>& rules, std::size_t num_chosen) {
    if (rules.empty()) return "";
    const Plot known = rule_plot(rules, num_chosen, "Ps known to 10 %", &LampRule::known);
    const Plot specular =
        rule_plot(rules, num_chosen, "Specular component measurable", &LampRule::specular);
    const Plot diffuse =
        rule_plot(rules, num_chosen, "Diffuse component measurable", &LampRule::diffuse);
    return html_figure(plot_legend(known.series) + "<div class=\"row\">" + svg_plot(known) +
                           svg_plot(specular) + svg_plot(diffuse) + "</div>",
                       "Every rule at equal number of lamps. Known to 10 %: by the standard error "
                       "that the looks allow. Measurable: two lamps near the highlight, or one "
                       "away from it. Random: the median of many draws; uniform: spread evenly.");
}

std::string lamp_rule_table(const std::vector<LampRule>& rules, std::size_t num_chosen) {
    if (rules.empty()) return "";
    HtmlTable table;
    table.columns = {
        "Rule", "lamps", "Ps known to 10 %", "specular measurable", "diffuse measurable"};
    for (const LampRule& rule : rules) {
        const std::size_t n = std::min(num_chosen, rule.known.size() - 1);
        table.rows.push_back({{rule.rule,
                               fmt::format("{}", n),
                               format_percent(rule.known[n]),
                               format_percent(rule.specular[n]),
                               format_percent(rule.diffuse[n])}});
    }
    return html_table(table);
}

}  // namespace patina
