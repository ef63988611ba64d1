#include "reports/step_file.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Circ.hxx>
#include <stdexcept>

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
    const TopoDS_Shape solid = BRepPrimAPI_MakePrism(floor, gp_Vec(0, 0, plate.height() * 1e3)).Shape();
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
