#include "tests/reports/step_reader.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Interface_InterfaceModel.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_Product.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Shape.hxx>
#include <XSControl_WorkSession.hxx>

namespace gradwright {

std::vector<ReadSolid> read_step(const std::string& path) {
    std::vector<ReadSolid> solids;
    STEPControl_Reader reader;
    if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return solids;
    reader.TransferRoots();
    for (TopExp_Explorer at(reader.OneShape(), TopAbs_SOLID); at.More(); at.Next()) {
        ReadSolid solid;
        solid.valid = BRepCheck_Analyzer(at.Current()).IsValid();
        GProp_GProps properties;
        BRepGProp::VolumeProperties(at.Current(), properties);
        solid.volume = properties.Mass();
        for (TopExp_Explorer face(at.Current(), TopAbs_FACE); face.More(); face.Next()) ++solid.faces;
        Bnd_Box box;
        BRepBndLib::AddOptimal(at.Current(), box, false, false);
        box.SetGap(0);
        box.Get(solid.box[0], solid.box[1], solid.box[2], solid.box[3], solid.box[4], solid.box[5]);
        solids.push_back(solid);
    }
    const Handle(Interface_InterfaceModel) model = reader.WS()->Model();
    std::size_t next = 0;
    for (int i = 1; i <= model->NbEntities(); ++i) {
        const Handle(StepBasic_Product) product = Handle(StepBasic_Product)::DownCast(model->Value(i));
        if (product.IsNull() || next >= solids.size()) continue;
        solids[next].name = product->Name()->ToCString();
        solids[next++].description = product->Description()->ToCString();
    }
    return solids;
}

std::vector<WellPart> read_well(const std::string& path, const std::array<double, 3>& low,
                                const std::array<double, 3>& high) {
    std::vector<WellPart> parts;
    STEPControl_Reader reader;
    if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return parts;
    reader.TransferRoots();
    TopoDS_Shape rest = BRepPrimAPI_MakeBox(gp_Pnt(low[0] * 1e3, low[1] * 1e3, low[2] * 1e3),
                                            gp_Pnt(high[0] * 1e3, high[1] * 1e3, high[2] * 1e3))
                            .Shape();
    for (TopExp_Explorer at(reader.OneShape(), TopAbs_SOLID); at.More(); at.Next())
        rest = BRepAlgoAPI_Cut(rest, at.Current()).Shape();
    for (TopExp_Explorer at(rest, TopAbs_SOLID); at.More(); at.Next()) {
        GProp_GProps properties;
        BRepGProp::VolumeProperties(at.Current(), properties);
        const gp_Pnt centre = properties.CentreOfMass();
        parts.push_back({properties.Mass() * 1e-9, {centre.X() * 1e-3, centre.Y() * 1e-3}});
    }
    return parts;
}

}  // namespace gradwright
