#include "reports/film.h"

#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "dem/stage.h"
#include "reports/webp_animation.h"

namespace gradwright {
namespace {

constexpr double kWidest = 1200, kHighest = 900;       // [px]
constexpr double kMargin = 16, kHead = 40, kGap = 30;  // [px] around, above for the words, between the views
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
constexpr float kQualities[] = {72, 50, 30};
constexpr int kFrame = 62, kFill = 1400, kDraw = 700, kRest = 2200;  // [ms]
constexpr int kRiseFrames = 10;

struct Rgb {
    double r, g, b;
};
// Okabe and Ito's blue and orange: told apart by colour-blind people, and in grey
constexpr Rgb kA = {0, 0.447, 0.698}, kB = {0.902, 0.624, 0}, kSolid = {0.67, 0.70, 0.73},
              kInk = {0.1, 0.12, 0.14};

/// Where things stand on the picture. Metres in, pixels out.
struct Frame {
    double x_low = 0, x_high = 0, z_low = 0, z_high = 0, width = 0, scale = 0;
    int pixels_wide = 0, pixels_high = 0;
    double side_bottom = 0, plan_bottom = 0;
    double x(double v) const { return kMargin + (v - x_low) * scale; }
    double z(double v) const { return side_bottom - (v - z_low) * scale; }
    double y(double v) const { return plan_bottom - v * scale; }
};

/// Highest grain that any instant holds above the machine [m].
double highest(std::span<const Snapshot> instants, double x_high) {
    double top = 0;
    for (const Snapshot& shot : instants)
        for (std::size_t i = 0; i < shot.x.size(); ++i)
            if (shot.x[i] < x_high) top = std::max(top, double(shot.z[i]) + shot.radius[i]);
    return top;
}

Frame frame_of(const Scene& scene, std::span<const Snapshot> instants) {
    Frame f;
    const double end = platform_end(scene);
    f.x_low = -0.02 * end;
    f.x_high = end + std::min(scene.second_land, 0.12 * end);
    f.width = scene.width;
    f.z_low = -deepest_floor(scene) - scene.dose_height - 0.02 * end;
    f.z_high = std::min(highest(instants, f.x_high), 0.35 * (f.x_high - f.x_low)) + 0.01 * end;
    const double along = f.x_high - f.x_low, up = f.z_high - f.z_low + f.width;
    f.scale = std::min((kWidest - 2 * kMargin) / along, (kHighest - kHead - kGap - kMargin) / up);
    const auto even = [](double v) { return 2 * static_cast<int>(std::ceil(v / 2)); };
    // the words need their room, whatever the machine's shape
    f.pixels_wide = std::max(480, even(along * f.scale + 2 * kMargin));
    f.side_bottom = kHead + (f.z_high - f.z_low) * f.scale;
    f.plan_bottom = f.side_bottom + kGap + f.width * f.scale;
    f.pixels_high = even(f.plan_bottom + kMargin);
    return f;
}

/// One picture: what stands where, beside the grains of `shot`.
struct Moment {
    const Snapshot* shot = nullptr;
    double sunk = 0;   ///< the bed below where it is when the blade comes [m]
    double floor = 0;  ///< z of the dispenser's floor [m]
    bool partition = false;
    bool blade = false;
    std::string words;
};

class Painter {
  public:
    Painter(const Scene& scene, const PartitionCurve& partition, const Frame& frame)
        : scene_(scene), frame_(frame) {
        for (const auto& curve : {partition.clipped(scene.dispenser_length, scene.width),
                                  partition.second_clipped(scene.dispenser_length, scene.width)})
            if (curve.size() > 1) curves_.push_back(curve);
        surface_ = cairo_image_surface_create(CAIRO_FORMAT_RGB24, frame.pixels_wide, frame.pixels_high);
        pen_ = cairo_create(surface_);
        if (cairo_status(pen_) != CAIRO_STATUS_SUCCESS) {
            const std::string why = cairo_status_to_string(cairo_status(pen_));
            cairo_destroy(pen_);
            cairo_surface_destroy(surface_);
            throw std::runtime_error("film: " + why);
        }
        cairo_select_font_face(pen_, "Liberation Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
        cairo_set_font_size(pen_, 14);
    }
    ~Painter() {
        cairo_destroy(pen_);
        cairo_surface_destroy(surface_);
    }
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

    void draw(const Moment& m) {
        colour({1, 1, 1});
        cairo_paint(pen_);
        side(m);
        from_above(m);
        head(m);
        cairo_surface_flush(surface_);
    }
    const std::uint8_t* pixels() const { return cairo_image_surface_get_data(surface_); }
    int stride() const { return cairo_image_surface_get_stride(surface_); }

  private:
    void colour(Rgb c, double opacity = 1) { cairo_set_source_rgba(pen_, c.r, c.g, c.b, opacity); }
    void box(double left, double top, double right, double bottom) {
        cairo_rectangle(pen_, left, top, right - left, bottom - top);
        cairo_fill(pen_);
    }
    void grain(double x, double y, double radius, Rgb c, double light) {
        cairo_arc(pen_, x, y, std::max(radius, 0.6), 0, 2 * std::numbers::pi);
        colour({std::min(1.0, c.r * light), std::min(1.0, c.g * light), std::min(1.0, c.b * light)});
        if (radius < 2.5) return cairo_fill(pen_);  // an outline would be all of it
        cairo_fill_preserve(pen_);
        colour({0, 0, 0}, 0.3);
        cairo_set_line_width(pen_, 0.7);
        cairo_stroke(pen_);
    }
    double y_of(const Snapshot& shot, std::size_t i) const {
        const double y = shot.y[i];
        return scene_.sides == Sides::periodic ? y - std::floor(y / scene_.width) * scene_.width : y;
    }
    double platform_floor() const {
        return -scene_.gap - scene_.substrate_depth() - (scene_.layers - 1) * scene_.sink();
    }

    /// A slice as thick as three median grains at half the width, the farthest grains first.
    void side(const Moment& m) {
        const Frame& f = frame_;
        const double half = 1.5 * scene_.powder[0].size.d50, bottom = f.side_bottom;
        const double start = platform_start(scene_), end = platform_end(scene_);
        cairo_save(pen_);
        cairo_rectangle(pen_, f.x(f.x_low), kHead, (f.x_high - f.x_low) * f.scale, bottom - kHead);
        cairo_clip(pen_);
        colour(kSolid);
        box(f.x(f.x_low), f.z(0), f.x(0), bottom);
        box(f.x(0), f.z(m.floor), f.x(scene_.dispenser_length), bottom);
        box(f.x(scene_.dispenser_length), f.z(0), f.x(start), bottom);
        box(f.x(start), f.z(platform_floor()), f.x(end), bottom);
        box(f.x(end), f.z(0), f.x(f.x_high), bottom);
        const Snapshot& shot = *m.shot;
        std::vector<std::pair<double, std::size_t>> cut;
        for (std::size_t i = 0; i < shot.x.size(); ++i)
            if (const double away = y_of(shot, i) - scene_.width / 2;
                std::abs(away) < half && shot.x[i] < f.x_high)
                cut.emplace_back(-away, i);
        std::sort(cut.begin(), cut.end());
        for (const auto& [nearness, i] : cut)
            grain(f.x(shot.x[i]), f.z(shot.z[i] - m.sunk), shot.radius[i] * f.scale, shot.is_a[i] ? kA : kB,
                  0.8 + 0.2 * (nearness + half) / (2 * half));
        if (m.blade) {
            const double front = f.x(shot.blade_x), back = f.x(shot.blade_x - scene_.blade_thickness);
            colour(kInk, 0.8);
            box(back, kHead, front, f.z(0));
        }
        cairo_restore(pen_);
    }

    void from_above(const Moment& m) {
        const Frame& f = frame_;
        const double top = f.y(scene_.width), bottom = f.y(0);
        cairo_save(pen_);
        cairo_rectangle(pen_, f.x(f.x_low), top, (f.x_high - f.x_low) * f.scale, bottom - top);
        cairo_clip(pen_);
        colour({0.87, 0.89, 0.91});
        cairo_paint(pen_);
        colour({0.35, 0.38, 0.41});
        box(f.x(0), top, f.x(scene_.dispenser_length), bottom);
        colour(kSolid);
        box(f.x(platform_start(scene_)), top, f.x(platform_end(scene_)), bottom);
        const Snapshot& shot = *m.shot;
        order_.resize(shot.x.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
            return shot.z[a] != shot.z[b] ? shot.z[a] < shot.z[b] : a < b;
        });
        const double deep = f.z_low, high = std::max(f.z_high, deep + 1e-9);
        for (const std::size_t i : order_) {
            if (!(shot.x[i] < f.x_high) || shot.z[i] < deep) continue;
            const double light = 0.72 + 0.4 * std::clamp((shot.z[i] - deep) / (high - deep), 0.0, 1.0);
            grain(f.x(shot.x[i]), f.y(y_of(shot, i)), shot.radius[i] * f.scale, shot.is_a[i] ? kA : kB,
                  light);
        }
        if (m.partition)
            for (const auto& curve : curves_)
                for (const auto& [line, c] : {std::pair{6.0, Rgb{1, 1, 1}}, std::pair{3.0, kInk}}) {
                    for (const PlanPoint& p : curve) cairo_line_to(pen_, f.x(p.x), f.y(p.y));
                    cairo_set_line_width(pen_, line);
                    colour(c);
                    cairo_stroke(pen_);
                }
        if (m.blade) {
            colour(kInk, 0.35);
            box(f.x(shot.blade_x - scene_.blade_thickness), top, f.x(shot.blade_x), bottom);
            colour(kInk);
            box(f.x(shot.blade_x) - 2, top, f.x(shot.blade_x), bottom);
        }
        cairo_restore(pen_);
        colour(kInk);
        cairo_set_line_width(pen_, 1);
        for (const auto& [from, to] : {std::pair{0.0, scene_.dispenser_length},
                                       std::pair{platform_start(scene_), platform_end(scene_)}}) {
            cairo_rectangle(pen_, f.x(from), top, (to - from) * f.scale, bottom - top);
            cairo_stroke(pen_);
        }
    }

    void words(double x, double y, const std::string& text, bool to_the_left = false) {
        cairo_text_extents_t size;
        cairo_text_extents(pen_, text.c_str(), &size);
        cairo_move_to(pen_, to_the_left ? x - size.x_advance : x, y);
        cairo_show_text(pen_, text.c_str());
    }
    void head(const Moment& m) {
        const Frame& f = frame_;
        double x = kMargin;
        for (int k = 0; k < 2; ++k) {
            grain(x + 6, 19, 6, k == 0 ? kA : kB, 1);
            colour(kInk);
            const std::string name =
                fmt::format("{}  {}", "AB"[k], scene_.powder[static_cast<std::size_t>(k)].material.name);
            words(x + 17, 24, name);
            cairo_text_extents_t size;
            cairo_text_extents(pen_, name.c_str(), &size);
            x += 36 + size.x_advance;
        }
        words(f.pixels_wide - kMargin, 24, m.words, true);
        cairo_set_font_size(pen_, 12);
        words(kMargin, f.side_bottom + 20, "cut at half the width (above), and from above");
        const double wanted = 0.16 * (f.x_high - f.x_low),
                     decade = std::pow(10, std::floor(std::log10(wanted)));
        const double bar = wanted >= 5 * decade ? 5 * decade : wanted >= 2 * decade ? 2 * decade : decade;
        const double right = f.pixels_wide - kMargin, line = f.side_bottom + 16;
        box(right - bar * f.scale, line - 2, right, line + 1);
        words(right - bar * f.scale - 8, line + 4, fmt::format("{:.4g} mm", bar * 1e3), true);
        cairo_set_font_size(pen_, 14);
    }

    const Scene& scene_;
    Frame frame_;
    std::vector<std::vector<PlanPoint>> curves_;
    std::vector<std::size_t> order_;
    cairo_surface_t* surface_ = nullptr;
    cairo_t* pen_ = nullptr;
};

std::string film_of_quality(const Scene& scene, const PartitionCurve& partition,
                            std::span<const Snapshot> instants, float quality) {
    const Frame frame = frame_of(scene, instants);
    Painter painter(scene, partition, frame);
    WebpAnimation film(frame.pixels_wide, frame.pixels_high, quality);
    const auto show = [&](const Moment& moment, int milliseconds) {
        painter.draw(moment);
        film.add(painter.pixels(), painter.stride(), milliseconds);
    };
    const std::string layer =
        scene.layers > 1 ? fmt::format("layer {} of {}, ", scene.layers, scene.layers) : "";
    Moment m;
    m.shot = &instants.front();
    m.sunk = scene.dose_height;
    m.floor = -scene.floor_depth() - scene.dose_height;
    m.partition = true;
    m.words = "filled on both sides of the partition";
    show(m, kFill);
    m.partition = false;
    m.words = "partition drawn out";
    show(m, kDraw);
    m.words = fmt::format("the floor rises by {:.0f} um", scene.dose_height * 1e6);
    for (int k = 1; k <= kRiseFrames; ++k) {
        m.sunk = scene.dose_height * (1 - double(k) / kRiseFrames);
        m.floor = -scene.floor_depth() - m.sunk;
        show(m, kFrame);
    }
    m.floor = -scene.bed_depth;
    m.blade = true;
    for (const Snapshot& shot : instants.subspan(1, instants.size() - 2)) {
        m.shot = &shot;
        m.words = fmt::format("{}t = {:.1f} ms, blade at x = {:.2f} mm", layer, shot.time * 1e3,
                              shot.blade_x * 1e3);
        show(m, kFrame);
    }
    m.shot = &instants.back();
    m.blade = false;
    m.words = fmt::format("{}t = {:.1f} ms, the layer", layer, instants.back().time * 1e3);
    show(m, kRest);
    return film.finish();
}

}  // namespace

std::string film_webp(const Scene& scene, const PartitionCurve& partition,
                      std::span<const Snapshot> instants) {
    if (instants.size() < 2) throw std::invalid_argument("a film needs the spread's first and last instant");
    std::string film;
    for (const float quality : kQualities) {
        film = film_of_quality(scene, partition, instants, quality);
        if (film.size() <= kMostBytes) break;
    }
    return film;
}

}  // namespace gradwright
