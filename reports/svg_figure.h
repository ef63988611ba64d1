// A small drawing board: SVG elements in pixels, linear axes, colour scales. One figure is one self-contained
// document with text as text. Undefined points (NaN) leave gaps.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace gradwright {

inline constexpr const char* kColourA = "#0072B2";  // Okabe-Ito: told apart with every kind of colour vision
inline constexpr const char* kColourB = "#E69F00";

class SvgFigure {
  public:
    /// `title` stands on top of the picture and is its accessible name.
    SvgFigure(double width, double height, const std::string& title);

    struct Pen {
        std::string colour = "#222";
        double width = 1.2;
        std::string dash = {};  ///< SVG dash array; empty = solid
    };
    struct Words {
        const char* anchor = "start";  ///< start | middle | end
        double size = 13;
        std::string colour = "#111";
        bool bold = false;
        double turn_deg = 0;  ///< clockwise about the anchor
    };
    void rect(double x, double y, double width, double height, const std::string& fill);
    void line(double x1, double y1, double x2, double y2, const Pen& pen);
    /// SVG path data; fill "none" for a line.
    void path(const std::string& data, const Pen& pen, const std::string& fill = "none", double opacity = 1);
    /// A grain of powder A or B.
    void grain(double x, double y, double radius, bool is_a);
    /// Circles of one colour as one path.
    void discs(std::span<const double> x, std::span<const double> y, std::span<const double> radius,
               const std::string& fill);
    void arrow(double x, double y, double dx, double dy, const Pen& pen);
    void text(double x, double y, const std::string& words, const Words& look);
    /// Vertical or horizontal strip of a colour scale over [low, high] with ticks.
    void colour_bar(double x, double y, double length, bool vertical, double low, double high,
                    std::string (*colour)(double), const std::string& label);
    std::string document() const;

  private:
    double width_, height_;
    std::string title_, body_;
};

/// Linear axes in a rectangle of a figure; y grows upwards.
class Axes {
  public:
    struct Range {
        double low = 0, high = 1;
    };
    Axes(SvgFigure& figure, double left, double top, double width, double height, Range x, Range y);
    double px(double x) const { return left_ + (x - x_.low) / (x_.high - x_.low) * width_; }
    double py(double y) const { return top_ + height_ - (y - y_.low) / (y_.high - y_.low) * height_; }
    /// Frame, ticks and labels, drawn over what lies inside. `grid`: faint lines at the ticks.
    void frame(const std::string& x_label, const std::string& y_label, bool grid = false);
    void curve(std::span<const double> x, std::span<const double> y, const SvgFigure::Pen& pen);
    void band(std::span<const double> x, std::span<const double> low, std::span<const double> high,
              const std::string& fill, double opacity = 0.2);
    void dots(std::span<const double> x, std::span<const double> y, double radius, const std::string& fill);
    void bars(std::span<const double> x, std::span<const double> low, std::span<const double> high,
              const SvgFigure::Pen& pen);

  private:
    SvgFigure& figure_;
    double left_, top_, width_, height_;
    Range x_, y_;
};

/// Round numbers that cover [low, high] with at most `most` steps.
std::vector<double> ticks(double low, double high, int most);

// Colours of a share in [0, 1], clipped; NaN is light grey.
std::string gi_colour(double gi);           ///< orange (B) - cream - blue (A), as in the report
std::string sequence_colour(double share);  ///< viridis
std::string sign_colour(double share);      ///< 0 red, 0.5 white, 1 blue

}  // namespace gradwright
