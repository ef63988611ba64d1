// A sheet of paper drawn once and written as PDF or SVG by cairo. Millimetres, origin top left, y down. The
// bytes depend on what is drawn alone: no dates.
#pragma once
#include <functional>
#include <string>
#include <vector>

struct _cairo;

namespace gradwright {

struct SheetPoint {
    double x = 0, y = 0;  ///< [mm]
};

class CairoSheet {
  public:
    struct Colour {
        double red = 0, green = 0, blue = 0, alpha = 1;
    };
    struct Pen {
        double width = 0.25;  ///< [mm]; ISO 128 groups 0.25 and 0.5
        Colour colour = {};
        std::vector<double> dash = {};
    };
    enum class Anchor { start, middle, end };
    struct Look {
        double size = 2.5;  ///< height of the letters' body [mm]
        Anchor anchor = Anchor::start;
        bool bold = false;
        double turn_deg = 0;  ///< counter-clockwise about the anchor
        Colour colour = {};
    };

    explicit CairoSheet(_cairo* context) : context_(context) {}
    void line(SheetPoint a, SheetPoint b, const Pen& pen);
    void rectangle(double x, double y, double width, double height, const Pen& pen);
    void polyline(const std::vector<SheetPoint>& points, const Pen& pen, bool closed = false);
    void fill(const std::vector<SheetPoint>& points, const Colour& colour);
    /// Filled tip at `at`, pointing along (dx, dy).
    void tip(SheetPoint at, double dx, double dy, double size = 2.2);
    /// A line with tips at both ends and words above its middle; the words stand beside it where it is short.
    void dimension(SheetPoint a, SheetPoint b, const std::string& words);
    void text(SheetPoint at, const std::string& words, const Look& look);
    double text_width(const std::string& words, const Look& look) const;
    /// Words broken into lines of at most `width`; returns the y below the last one.
    double paragraph(SheetPoint at, double width, const std::string& words, const Look& look,
                     double spacing = 1.35);
    std::vector<std::string> broken(double width, const std::string& words, const Look& look) const;

  private:
    void stroke(const Pen& pen);
    void choose(const Look& look) const;
    _cairo* context_;
};

using DrawPage = std::function<void(CairoSheet&)>;

/// Several pages of one size. Throws std::runtime_error with cairo's reason.
std::string pdf_of(double width, double height, const std::vector<DrawPage>& pages, const std::string& title);
std::string svg_of(double width, double height, const DrawPage& page);

}  // namespace gradwright
