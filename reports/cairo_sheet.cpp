#include "reports/cairo_sheet.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace gradwright {
namespace {

constexpr double kPoints = 72 / 25.4;  // PDF and SVG surfaces of cairo count in points

struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
};

cairo_status_t append(void* out, const unsigned char* bytes, unsigned count) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
}

/// Draws the pages on a surface made by `make`, which writes into the string it is given.
template <class Make>
std::string drawn(const std::vector<DrawPage>& pages, const Make& make) {
    std::string out;
    {
        const std::unique_ptr<cairo_surface_t, Destroy> surface(make(&out));
        const std::unique_ptr<cairo_t, Destroy> context(cairo_create(surface.get()));
        for (const DrawPage& page : pages) {
            cairo_save(context.get());
            cairo_scale(context.get(), kPoints, kPoints);
            CairoSheet sheet(context.get());
            page(sheet);
            cairo_restore(context.get());
            cairo_show_page(context.get());
        }
        cairo_surface_finish(surface.get());
        for (const cairo_status_t status : {cairo_status(context.get()), cairo_surface_status(surface.get())})
            if (status != CAIRO_STATUS_SUCCESS)
                throw std::runtime_error(std::string("cairo: ") + cairo_status_to_string(status));
    }
    return out;
}

}  // namespace

void CairoSheet::stroke(const Pen& pen) {
    cairo_set_line_width(context_, pen.width);
    cairo_set_source_rgba(context_, pen.colour.red, pen.colour.green, pen.colour.blue, pen.colour.alpha);
    cairo_set_dash(context_, pen.dash.data(), static_cast<int>(pen.dash.size()), 0);
    cairo_stroke(context_);
}

void CairoSheet::line(SheetPoint a, SheetPoint b, const Pen& pen) {
    cairo_move_to(context_, a.x, a.y);
    cairo_line_to(context_, b.x, b.y);
    stroke(pen);
}

void CairoSheet::rectangle(double x, double y, double width, double height, const Pen& pen) {
    cairo_rectangle(context_, x, y, width, height);
    stroke(pen);
}

void CairoSheet::polyline(const std::vector<SheetPoint>& points, const Pen& pen, bool closed) {
    for (const SheetPoint& p : points) cairo_line_to(context_, p.x, p.y);
    if (closed) cairo_close_path(context_);
    stroke(pen);
}

void CairoSheet::fill(const std::vector<SheetPoint>& points, const Colour& colour) {
    for (const SheetPoint& p : points) cairo_line_to(context_, p.x, p.y);
    cairo_close_path(context_);
    cairo_set_source_rgba(context_, colour.red, colour.green, colour.blue, colour.alpha);
    cairo_fill(context_);
}

void CairoSheet::tip(SheetPoint at, double dx, double dy, double size) {
    const double length = std::hypot(dx, dy);
    if (!(length > 0)) return;
    const double ux = dx / length, uy = dy / length, half = 0.17 * size;
    fill({at,
          {at.x - size * ux - half * uy, at.y - size * uy + half * ux},
          {at.x - size * ux + half * uy, at.y - size * uy - half * ux}},
         {});
}

void CairoSheet::dimension(SheetPoint a, SheetPoint b, const std::string& words) {
    const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
    constexpr double kTip = 2.2, kOut = 5;
    const Look look{.size = 2.6, .anchor = Anchor::middle};
    const double needed = text_width(words, look);
    double angle = std::atan2(-dy, dx) * 180 / std::numbers::pi;
    if (angle > 91 || angle < -89) angle += angle > 0 ? -180 : 180;
    const double ux = length > 0 ? dx / length : 1, uy = length > 0 ? dy / length : 0;
    const double turned = angle * std::numbers::pi / 180;
    const SheetPoint above = {-0.8 * std::sin(turned), -0.8 * std::cos(turned)};
    if (length > 2 * kTip + 0.5) {
        line(a, b, {.width = 0.18});
        tip(a, -dx, -dy, kTip);
        tip(b, dx, dy, kTip);
    } else {  // tips from outside
        line({a.x - kOut * ux, a.y - kOut * uy}, {b.x + kOut * ux, b.y + kOut * uy}, {.width = 0.18});
        tip(a, dx, dy, kTip);
        tip(b, -dx, -dy, kTip);
    }
    SheetPoint at = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y)};
    if (needed > length - 1) {
        const double away = 0.5 * length + kOut + 0.5 * needed;
        line({b.x, b.y}, {b.x + (kOut + needed) * ux, b.y + (kOut + needed) * uy}, {.width = 0.18});
        at = {at.x + away * ux, at.y + away * uy};
    }
    Look words_look = look;
    words_look.turn_deg = angle;
    text({at.x + above.x, at.y + above.y}, words, words_look);
}

void CairoSheet::choose(const Look& look) const {
    cairo_select_font_face(context_, "Liberation Sans", CAIRO_FONT_SLANT_NORMAL,
                           look.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_, look.size);
}

double CairoSheet::text_width(const std::string& words, const Look& look) const {
    choose(look);
    cairo_text_extents_t extents;
    cairo_text_extents(context_, words.c_str(), &extents);
    return extents.x_advance;
}

void CairoSheet::text(SheetPoint at, const std::string& words, const Look& look) {
    if (words.empty()) return;
    const double width = text_width(words, look);
    const double back = look.anchor == Anchor::start    ? 0
                        : look.anchor == Anchor::middle ? 0.5 * width
                                                        : width;
    cairo_save(context_);
    cairo_translate(context_, at.x, at.y);
    cairo_rotate(context_, -look.turn_deg * std::numbers::pi / 180);
    cairo_move_to(context_, -back, 0);
    cairo_set_source_rgba(context_, look.colour.red, look.colour.green, look.colour.blue, look.colour.alpha);
    cairo_show_text(context_, words.c_str());
    cairo_restore(context_);
    cairo_new_path(context_);
}

std::vector<std::string> CairoSheet::broken(double width, const std::string& words, const Look& look) const {
    std::vector<std::string> lines;
    std::istringstream stream(words);
    std::string line;
    for (std::string word; stream >> word;) {
        const std::string longer = line.empty() ? word : line + " " + word;
        if (!line.empty() && text_width(longer, look) > width) {
            lines.push_back(line);
            line = word;
        } else {
            line = longer;
        }
    }
    if (!line.empty()) lines.push_back(line);
    return lines;
}

double CairoSheet::paragraph(SheetPoint at, double width, const std::string& words, const Look& look,
                             double spacing) {
    for (const std::string& line : broken(width, words, look)) {
        text(at, line, look);
        at.y += spacing * look.size;
    }
    return at.y;
}

std::string pdf_of(double width, double height, const std::vector<DrawPage>& pages,
                   const std::string& title) {
    return drawn(pages, [&](std::string* out) {
        cairo_surface_t* surface =
            cairo_pdf_surface_create_for_stream(append, out, width * kPoints, height * kPoints);
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_TITLE, title.c_str());
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATOR, "gradwright");
        // cairo would write today's date: the same drawing shall give the same bytes
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
        return surface;
    });
}

std::string svg_of(double width, double height, const DrawPage& page) {
    const std::string text = drawn({page}, [&](std::string* out) {
        cairo_surface_t* surface =
            cairo_svg_surface_create_for_stream(append, out, width * kPoints, height * kPoints);
        cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PT);
        return surface;
    });
    // cairo numbers its surfaces through the life of a process: two drawings would differ by these numbers
    return std::regex_replace(text, std::regex("surface[0-9]+"), "surface1");
}

}  // namespace gradwright
