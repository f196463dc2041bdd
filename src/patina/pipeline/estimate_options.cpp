// The settings of `patina estimate`, and the names of its methods.
#include "patina/pipeline/estimate_capture.h"

namespace patina {
namespace {

Choices<Method> method_choices() {
    return {{"direct", Method::direct},
            {"diffuse", Method::diffuse},
            {"photon", Method::photon},
            {"gather", Method::gather}};
}

Option graph_option(std::filesystem::path& field) {
    Option option = path_option("graph",
                                "FILE|none",
                                field,
                                "keep the graph of method gather there, and reuse it where "
                                "geometry, cameras and settings are the same");
    option.default_text = "RESULT.graph";
    return not_a_setting(option);
}

OptionTable fine_option_table(EstimateOptions& options) {
    ObservationOptions& looks = options.observations;
    FitOptions& fit = options.fit;
    RatioKernelOptions& kernel = options.kernel;
    const Range angle = between(1, 90);
    return {
        number_option("tolerance",
                      options.tolerance,
                      above(0),
                      "",
                      "stop when maps and E change by less, relative"),
        angle_option("max_light_angle",
                     looks.max_light_angle,
                     angle,
                     "leave out light further from the normal"),
        angle_option("max_view_angle",
                     looks.max_view_angle,
                     angle,
                     "leave out views further from the normal"),
        number_option("calibration_stddev",
                      looks.calibration_stddev,
                      at_least(0),
                      "",
                      "relative error of every radiance that no noise model covers"),
        number_option(
            "default_read_stddev",
            looks.default_read_stddev,
            above(0),
            "",
            "read noise where the capture states none, as a share of the 99th percentile"),
        angle_option("initial_roughness",
                     fit.initial_roughness,
                     between(1, 45),
                     "sigma that decides the first classes of pixels"),
        number_option("diffuse_share",
                      fit.diffuse_share,
                      between(0, 1),
                      "",
                      "predicted specular share below which a pixel counts as diffuse"),
        number_option("specular_share",
                      fit.specular_share,
                      between(0, 1),
                      "",
                      "predicted specular share above which a pixel counts as specular"),
        number_option("min_roughness",
                      fit.min_roughness,
                      between(kMinRoughness, kMaxRoughness),
                      "rad",
                      "smallest sigma of the search"),
        number_option("max_roughness",
                      fit.max_roughness,
                      between(kMinRoughness, kMaxRoughness),
                      "rad",
                      "largest sigma of the search"),
        integer_option("gather_rays",
                       options.gather.rays,
                       between(4, kMaxGatherRays),
                       "rays of method gather over the hemisphere of each texel"),
        integer_option("lobe_rays",
                       options.gather.lobe_rays,
                       between(8, kMaxGatherRays),
                       "rays of method gather towards the lobe of each texel and camera"),
        graph_option(options.graph_file),
        not_a_setting(number_option("memory",
                                    options.memory,
                                    above(0),
                                    "GiB",
                                    "what is needed",
                                    "stay within so much with method gather, if need be slower")),
        number_option("filter_radius",
                      options.filter_radius,
                      between(0.1, 20),
                      "texels",
                      "of the filter of the indirect light of method gather"),
        integer_option("max_bounces",
                       options.photons.max_bounces,
                       between(1, 1000),
                       "arrivals after which a photon is cut"),
        angle_option("azimuth_window",
                     options.photons.azimuth_window,
                     between(0.1, 180),
                     "half width of the columns that a photon of a turning lamp counts for"),
        number_option("kernel_arrivals",
                      kernel.arrivals,
                      above(0),
                      "",
                      "photons that a kernel of the irradiance should hold"),
        number_option("kernel_min_radius",
                      kernel.min_radius,
                      above(0),
                      "texels",
                      "smallest radius of a kernel"),
        number_option("kernel_max_radius",
                      kernel.max_radius,
                      above(0),
                      "texels",
                      "largest radius of a kernel"),
        integer_option(
            "kernel_max_texels", kernel.max_texels, between(1, 100'000), "most texels in a kernel"),
    };
}

}  // namespace

OptionTable estimate_option_table(EstimateOptions& options) {
    OptionTable table = {
        choice_option(
            "method",
            options.method,
            method_choices(),
            "what is known of bounced light: nothing; diffuse bounces; all, by photons as in the "
            "paper; all, by the gather graph"),
        choice_option("loop",
                      options.loop,
                      Choices<Loop>{{"damped", Loop::damped}, {"plain", Loop::plain}},
                      "how the maps follow a fit; plain is the paper's, which may diverge"),
        flag_option("literal",
                    options.fit.literal,
                    "as the paper: diffuse pixels hold no specular light at all"),
        choice_option("irradiance",
                      options.irradiance,
                      Choices<Irradiance>{{"ratio", Irradiance::ratio}, {"disc", Irradiance::disc}},
                      "how photons become irradiance; disc is the classical estimate, which is "
                      "wrong in corners"),
        integer_option("photons",
                       options.photons.photons,
                       between(2, 1e9),
                       "photons for each set of lamps that shine together"),
        integer_option("iterations",
                       options.max_iterations,
                       between(1, 100'000),
                       "most turns of the loop, for each of methods diffuse, photon and gather"),
        number_option("threshold",
                      options.threshold,
                      at_least(0),
                      "",
                      "stop when the error E of equation (5) falls below it [radiance^2]"),
    };
    for (Option& option : fine_option_table(options)) table.push_back(std::move(option));
    return table;
}

std::string method_name(Method method) { return choice_name(method_choices(), method); }

}  // namespace patina
