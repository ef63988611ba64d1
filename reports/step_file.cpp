#include "reports/step_file.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_Shell.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <gp_Pln.hxx>
#include <stdexcept>
#include <vector>

namespace gradwright {
namespace {

// Header dates differ from run to run; a hand-over's bytes must not.
constexpr const char* kTimeStamp = "2000-01-01T00:00:00";

Handle(TCollection_HAsciiString) ascii(const std::string& text) {
    std::string out;
    for (const char c : text) out += static_cast<unsigned char>(c) < 0x80 ? c : '?';
    return new TCollection_HAsciiString(out.c_str());
}

gp_Pnt point(PlanPoint p, double z) {
    return {p.x * 1e3, p.y * 1e3, z * 1e3};
}

/// One face of the strip over a piece of its middle line; `side` +1 left, -1 right.
TopoDS_Edge face_edge(const Plate& plate, const PlatePiece& piece, const Station& from, const Station& to,
                      int side, bool back) {
    const std::size_t s = side > 0 ? 0 : 1;
    PlanPoint a = from[s], b = to[s];
    if (piece.turn == 0) {
        if (back) std::swap(a, b);
        return BRepBuilderAPI_MakeEdge(point(a, plate.z_low), point(b, plate.z_low));
    }
    // the centre lies on the line through both faces, beyond the inner one
    const bool left = piece.turn > 0;
    const PlanPoint inner = from[left ? 0 : 1], outer = from[left ? 1 : 0];
    const double stretch = plate.bend_radius / plate.thickness;
    const PlanPoint centre = {inner.x + stretch * (inner.x - outer.x),
                              inner.y + stretch * (inner.y - outer.y)};
    const double radius = (side > 0) == left ? plate.bend_radius : plate.bend_radius + plate.thickness;
    const bool counter = left != back;
    if (back) std::swap(a, b);
    const gp_Circ circle(gp_Ax2(point(centre, plate.z_low), gp_Dir(0, 0, counter ? 1 : -1)), radius * 1e3);
    return BRepBuilderAPI_MakeEdge(circle, point(a, plate.z_low), point(b, plate.z_low));
}

/// What stands below the seats of the tabs, beyond the ends' cuts, taken away.
TopoDS_Shape below_tabs_cut(const Plate& plate, TopoDS_Shape solid) {
    for (const std::size_t e : {0u, 1u}) {
        const double by = plate.ends[e].cut;
        if (!(by > 0)) continue;
        const std::size_t n = plate.corners.size();
        const PlanPoint tip = plate.corners[e == 0 ? 0 : n - 1], inner = plate.corners[e == 0 ? 1 : n - 2];
        const double size = std::hypot(tip.x - inner.x, tip.y - inner.y);
        const PlanPoint out{(tip.x - inner.x) / size, (tip.y - inner.y) / size};
        const auto at = [&](double along, double across) {
            return point({tip.x + along * out.x - across * out.y, tip.y + along * out.y + across * out.x},
                         plate.z_low - plate.thickness);
        };
        // a block that stands over the plate on all sides but its two own faces
        const double wide = 2 * plate.thickness;
        const TopoDS_Wire foot = BRepBuilderAPI_MakePolygon(at(-by, -wide), at(plate.thickness, -wide),
                                                            at(plate.thickness, wide), at(-by, wide), true);
        const double tall = plate.z_seat - plate.z_low + plate.thickness;
        const TopoDS_Shape block =
            BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(foot, true), gp_Vec(0, 0, tall * 1e3)).Shape();
        BRepAlgoAPI_Cut cut(solid, block);
        if (!cut.IsDone()) throw std::runtime_error("the tabs of plate " + plate.name + " cannot be cut");
        solid = cut.Shape();
    }
    return solid;
}

/// The marks of one face as holes of it, each with walls and a floor: no Boolean operation, whatever their
/// number.
TopoDS_Shape engraved(const Plate& plate, const TopoDS_Shape& solid) {
    if (!(plate.mark_depth > 0) || plate.marks.empty()) return solid;
    std::vector<TopoDS_Face> faces;
    for (TopExp_Explorer at(solid, TopAbs_FACE); at.More(); at.Next())
        faces.push_back(TopoDS::Face(at.Current()));
    std::vector<std::vector<TopoDS_Wire>> holes(faces.size());
    std::vector<TopoDS_Face> pockets;
    for (const Mark& mark : plate.marks) {
        const PlatePiece& piece = plate.pieces[mark.piece];
        const double length = std::hypot(piece.to.x - piece.from.x, piece.to.y - piece.from.y);
        const PlanPoint d{(piece.to.x - piece.from.x) / length, (piece.to.y - piece.from.y) / length};
        const double side = mark.side == 0 ? 1 : -1, off = 0.5 * side * plate.thickness;
        const auto at = [&](double along, double z) {
            return point({piece.from.x + along * d.x - off * d.y, piece.from.y + along * d.y + off * d.x}, z);
        };
        // counter-clockwise as the outside sees it
        const bool right = mark.side == 1;
        const double first = right ? mark.from : mark.to, last = right ? mark.to : mark.from;
        const TopoDS_Wire rim = BRepBuilderAPI_MakePolygon(at(first, mark.low), at(last, mark.low),
                                                           at(last, mark.high), at(first, mark.high), true);
        const gp_Pnt middle = at(0.5 * (mark.from + mark.to), 0.5 * (mark.low + mark.high));
        std::size_t owner = faces.size();
        for (std::size_t f = 0; f < faces.size() && owner == faces.size(); ++f) {
            const BRepAdaptor_Surface surface(faces[f]);
            if (surface.GetType() != GeomAbs_Plane || surface.Plane().Distance(middle) > 1e-6) continue;
            if (BRepClass_FaceClassifier(faces[f], middle, 1e-6).State() == TopAbs_IN) owner = f;
        }
        if (owner == faces.size())
            throw std::runtime_error("plate " + plate.name + " has no face where it is to be engraved");
        holes[owner].push_back(TopoDS::Wire(rim.Reversed()));
        // rim and walls share their edges; the floor is the far end of the same prism, all turned inside out
        const TopoDS_Face lid = BRepBuilderAPI_MakeFace(rim, true);
        const double e = -side * plate.mark_depth * 1e3;
        BRepPrimAPI_MakePrism pocket(lid, gp_Vec(-e * d.y, e * d.x, 0));
        for (TopExp_Explorer face(pocket.Shape(), TopAbs_FACE); face.More(); face.Next())
            if (!face.Current().IsSame(lid)) pockets.push_back(TopoDS::Face(face.Current().Reversed()));
    }
    BRep_Builder builder;
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (holes[f].empty()) {
            builder.Add(shell, faces[f]);
            continue;
        }
        BRepBuilderAPI_MakeFace face(faces[f]);
        for (const TopoDS_Wire& hole : holes[f]) face.Add(hole);
        builder.Add(shell, face.Face());
    }
    for (const TopoDS_Face& face : pockets) builder.Add(shell, face);
    shell.Closed(true);
    return BRepBuilderAPI_MakeSolid(shell).Solid();
}

TopoDS_Shape solid_of(const Plate& plate) {
    // one chord an arc: its two stations are its ends
    const std::vector<Station> stations = plate.stations(1);
    BRepBuilderAPI_MakeWire wire;
    const auto straight = [&](PlanPoint a, PlanPoint b) {
        wire.Add(BRepBuilderAPI_MakeEdge(point(a, plate.z_low), point(b, plate.z_low)));
    };
    const std::size_t n = plate.pieces.size();
    for (std::size_t i = 0; i < n; ++i)
        wire.Add(face_edge(plate, plate.pieces[i], stations[i], stations[i + 1], -1, false));
    straight(stations[n][1], stations[n][0]);
    for (std::size_t i = n; i-- > 0;)
        wire.Add(face_edge(plate, plate.pieces[i], stations[i], stations[i + 1], +1, true));
    straight(stations[0][0], stations[0][1]);
    const TopoDS_Face floor = BRepBuilderAPI_MakeFace(wire.Wire(), true);
    TopoDS_Shape solid = BRepPrimAPI_MakePrism(floor, gp_Vec(0, 0, plate.height() * 1e3)).Shape();
    solid = engraved(plate, below_tabs_cut(plate, solid));
    if (!BRepCheck_Analyzer(solid).IsValid())
        throw std::runtime_error("plate " + plate.name + " is no valid solid: its folds overlap");
    return solid;
}

}  // namespace

bool step_available() {
    return true;
}

void write_step(const std::vector<Plate>& plates, const StepNames& names, StepSchema schema,
                const std::string& path) {
    try {
        // OpenCASCADE reports its transfers on stdout, which belongs to the program
        Message::DefaultMessenger()->ChangePrinters().Clear();
        // before the writer: it makes its header from these
        STEPControl_Controller::Init();
        Interface_Static::SetCVal("write.step.schema", schema == StepSchema::ap242 ? "AP242DIS" : "AP214IS");
        Interface_Static::SetCVal("write.step.unit", "MM");
        // curves on planes and cylinders follow from those in space: readers need no second set
        Interface_Static::SetIVal("write.surfacecurve.mode", 0);
        STEPControl_Writer writer;
        for (const Plate& plate : plates)
            if (writer.Transfer(solid_of(plate), STEPControl_ManifoldSolidBrep) != IFSelect_RetDone)
                throw std::runtime_error("plate " + plate.name + " cannot be expressed in STEP");
        const Handle(StepData_StepModel) model = writer.Model();
        std::size_t next = 0;
        for (int i = 1; i <= model->NbEntities(); ++i) {
            const Handle(StepBasic_Product) product = Handle(StepBasic_Product)::DownCast(model->Value(i));
            if (product.IsNull() || next >= plates.size()) continue;
            const std::string name = names.product + " " + plates[next++].name;
            product->SetId(ascii(name));
            product->SetName(ascii(name));
            product->SetDescription(ascii(names.description));
        }
        APIHeaderSection_MakeHeader header(model);
        header.SetName(ascii(names.product));
        header.SetTimeStamp(ascii(kTimeStamp));
        header.SetAuthorValue(1, ascii(names.author));
        header.SetOrganizationValue(1, ascii(names.organisation));
        header.SetOriginatingSystem(ascii("gradwright"));
        header.SetDescriptionValue(1, ascii(names.title));
        if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("cannot write " + path);
    } catch (const Standard_Failure& failure) {
        throw std::runtime_error(std::string("OpenCASCADE: ") + failure.GetMessageString());
    }
}

}  // namespace gradwright
