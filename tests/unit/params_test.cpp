#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "engine/core/error.h"
#include "engine/params/groups.h"

#define HL_PARAM_LIST "tests/unit/params_example.inl"
#include "engine/params/declare_group.h"

namespace hl {
namespace {

const ParamInfo& info(const char* name) {
  for (const ParamInfo& p : exampleParamInfos())
    if (p.name == name) return p;
  throw std::logic_error(name);
}

/// The message of the error, which must be bad input.
template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::BadInput);
    return e.what();
  }
  ADD_FAILURE() << "was accepted";
  return {};
}

TEST(Params, StructHasTheDeclaredDefaultsAndLayout) {
  const ExampleParams p;
  EXPECT_EQ(p.samples, 1024);
  EXPECT_EQ(p.residual, 0.001f);
  EXPECT_EQ(p.clamped, 0);
  EXPECT_EQ(p.mode, kExampleModeMonteCarlo);
  static_assert(sizeof(ExampleParams) == 16);
  EXPECT_EQ(info("mode").offset, 12u);
}

TEST(Params, TableCarriesTheWholeDeclaration) {
  ASSERT_EQ(exampleParamInfos().size(), 4u);
  const ParamInfo& p = info("samples");
  EXPECT_EQ(p.key(), "example.samples");
  EXPECT_EQ(p.type, ParamType::Int);
  EXPECT_EQ(p.min, 1);
  EXPECT_EQ(p.max, 4096);
  EXPECT_EQ(p.softMin, 16);
  EXPECT_EQ(p.softMax, 2048);
  EXPECT_EQ(p.scale, ParamScale::Log);
  EXPECT_EQ(p.effect, Effect::Rebuild);
  EXPECT_EQ(p.unit, "rays");
  EXPECT_EQ(p.help, "Rays a texel sends.");
  EXPECT_EQ(info("clamped").help, "Whether the sum is clamped.");
  ASSERT_EQ(info("mode").values.size(), 3u);
  EXPECT_EQ(info("mode").values[2].name, "mipmapped");
  EXPECT_EQ(info("mode").values[1].help, "Drawn anew, for each texel.");
}

TEST(Params, ViewReadsAndWritesTheStruct) {
  ExampleParams p;
  ParamView view = exampleView(p);
  view.set(info("samples"), 7);
  view.set(info("residual"), 0.05f);
  view.set(info("clamped"), 1);
  view.set(info("mode"), int32_t{kExampleModeMipmapped});
  EXPECT_EQ(p.samples, 7);
  EXPECT_EQ(p.residual, 0.05f);
  EXPECT_EQ(p.clamped, 1);
  EXPECT_EQ(p.mode, kExampleModeMipmapped);
  EXPECT_FALSE(view.isDefault(info("samples")));
  view.reset();
  const ExampleParams fresh;
  EXPECT_EQ(std::memcmp(&p, &fresh, sizeof p), 0);
  EXPECT_TRUE(view.isDefault(info("residual")));
}

TEST(Params, TextRoundTripsThroughEveryType) {
  const std::pair<const char*, const char*> cases[] = {{"samples", "4096"}, {"residual", "0.1"},  {"residual", "1e-06"},
                                                       {"clamped", "true"}, {"clamped", "false"}, {"mode", "static"}};
  for (const auto& [name, text] : cases) EXPECT_EQ(formatParam(info(name), parseParam(info(name), text)), text) << name;
  EXPECT_EQ(std::get<int32_t>(parseParam(info("clamped"), "on")), 1);
  for (int i = 0; i < 1000; ++i) {
    const float v = 0.1f * static_cast<float>(i) / 1000.0f;
    EXPECT_EQ(std::get<float>(parseParam(info("residual"), formatParam(info("residual"), v))), v);
  }
}

TEST(Params, OutOfRangeNamesKeyValueAndRange) {
  EXPECT_EQ(refusal([] { parseParam(info("samples"), "5000"); }),
            "example.samples = 5000: out of range [1, 4096] rays");
  EXPECT_EQ(refusal([] { parseParam(info("residual"), "0.2"); }), "example.residual = 0.2: out of range [0, 0.1]");
  EXPECT_EQ(refusal([] { parseParam(info("samples"), "99999999999"); }),
            "example.samples = 99999999999: out of range [1, 4096] rays");
  ExampleParams p;
  ParamView view = exampleView(p);
  EXPECT_NE(refusal([&] { view.set(info("samples"), 0); }).find("[1, 4096]"), std::string::npos);
  EXPECT_NE(refusal([&] { view.set(info("mode"), 3); }).find("static, monte_carlo, mipmapped"), std::string::npos);
  EXPECT_NE(refusal([&] { view.set(info("residual"), std::numeric_limits<float>::quiet_NaN()); }).find("finite"),
            std::string::npos);
  EXPECT_EQ(p.samples, 1024) << "a refused value must leave the old one";
}

TEST(Params, WrongTypesAreRefused) {
  for (const char* text : {"", "1.5", "12x", " 12", "0x10", "many"})
    EXPECT_NE(refusal([&] { parseParam(info("samples"), text); }).find("whole number"), std::string::npos) << text;
  for (const char* text : {"", "half", "0.1.2", "nan", "inf", "-inf"})
    EXPECT_NE(refusal([&] { parseParam(info("residual"), text); }).find("number"), std::string::npos) << text;
  EXPECT_NE(refusal([] { parseParam(info("clamped"), "yes please"); }).find("true or false"), std::string::npos);
  EXPECT_EQ(refusal([] { parseParam(info("mode"), "mipmaped"); }),
            "example.mode = mipmaped: not one of static, monte_carlo, mipmapped; did you mean mipmapped?");
}

TEST(Params, SetFindsByKeyAndNamesTheNearest) {
  ExampleParams example;
  LightmapParams lightmap;
  ParamSet set;
  set.add(exampleView(example));
  set.add(lightmapView(lightmap));
  const ParamSet::Found found = set.find("lightmap.resolution");
  found.view->set(*found.info, 512);
  EXPECT_EQ(lightmap.resolution, 512);
  EXPECT_TRUE(set.contains("example.mode"));
  EXPECT_FALSE(set.contains("mode"));
  EXPECT_EQ(refusal([&] { set.find("lightmap.resolutoin"); }),
            "unknown parameter \"lightmap.resolutoin\"; did you mean lightmap.resolution?");
}

TEST(Params, SharedGroupsHoldWhatTheDesignStates) {
  const LightmapParams lightmap;
  EXPECT_EQ(lightmap.resolution, 256);
  EXPECT_EQ(lightmap.dilation, 2);
  EXPECT_FLOAT_EQ(lightmap.uv_overlap_tolerance, 0.001f);
  EXPECT_EQ(sharedParamGroups().size(), 4u);
}

}  // namespace
}  // namespace hl
