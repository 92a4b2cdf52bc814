// The radivox command. Exit codes: 0 done, 2 bad usage or input, 3 the device cannot, 4 out of memory, 130 interrupted.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>

#include "engine/error.h"
#include "engine/params/params.h"
#include "samples/cli/assets.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/options.h"
#include "samples/report/options.h"
#include "samples/stability/options.h"
#include "samples/viewer/view_command.h"

namespace radivox::cli {

namespace {

constexpr int kInternalErrorExitCode = 1;

int exitCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::BadInput:
      return 2;
    case ErrorCode::Unsupported:
    case ErrorCode::DeviceFailed:
      return 3;
    case ErrorCode::OutOfMemory:
      return 4;
  }
  return kInternalErrorExitCode;
}

/// Always one line.
void printError(std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fprintf(stderr, "radivox: %s\n", message.c_str());
}

void addRepeated(CLI::App* command, const std::string& name, std::vector<std::string>& to, const std::string& help,
                 const std::string& value) {
  // One value each time, so that a SCENE that follows is not swallowed.
  command->add_option(name, to, help)->type_name(value)->allow_extra_args(false)->take_all();
}

/// `takesPresets`: the command has --preset, too.
void addGraphOption(CLI::App* command, Options& options, const std::string& fallback, bool takesPresets = true) {
  const std::string source = takesPresets ? "the preset's, else " : "";
  command->add_option("--graph", options.graph, "a graph of `radivox info`, or a file (default: " + source + fallback + ")")
      ->type_name("NAME|FILE.json");
}

void addSkyOption(CLI::App* command, Options& options) {
  command
      ->add_option("--sky", options.sky,
                   "instead of the scene's sky: an equirectangular image or builtin:clear, with ?scale=X&turn=DEGREES&sun=keep")
      ->type_name("FILE.exr|.hdr");
}

void addSceneOptions(CLI::App* command, Options& options, const std::string& fallback = "") {
  command->add_option("SCENE", options.scene, "a .gltf or .glb file, or builtin:NAME[?key=value&...]" + fallback)->type_name("");
  addSkyOption(command, options);
}

void addPlanOptions(CLI::App* command, Options& options) {
  addSceneOptions(command, options);
  addGraphOption(command, options, kPictureGraph);
  addRepeated(command, "--preset", options.presets, "settings to start from; may be repeated (without it and --graph: default)",
              "NAME|FILE.json");
  addRepeated(command, "--set", options.sets, "one parameter; may be repeated", "node.param=value");
  command->add_option("--bounces", options.bounces, "indirect bounces: 0 is direct light only, all (default) the converged solution")
      ->type_name("N|all");
  command->add_option("--camera", options.camera, "camera of the scene (default: the first)")->type_name("NAME|INDEX");
  command->add_option("--size", options.size, "pixels (default: 960x540)")->type_name("WxH");
  command->add_option("--supersample", options.supersample, "each pixel is the mean of K x K (default: the preset's, or 1)")
      ->type_name("K");
  command->add_option("--aov", options.aovs, "what to write, linear (default: color)")->type_name("NAME[,NAME...]");
  command->add_flag("--keep-all", options.keepAll, "leave nothing out, needed or not: the same picture, at the whole cost");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  addRepeated(command, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
}

void addReferenceOptions(CLI::App* command, Options& options, ReferenceOptions& reference) {
  addSceneOptions(command, options);
  command->add_option("--bounces", options.bounces, "indirect bounces: 0 is direct light only, all (default) every one")
      ->type_name("N|all");
  command->add_option("--spp", reference.spp, "most samples a pixel, or a point with --probe (default: 64)")->type_name("N");
  command->add_option("--seed", reference.seed, "another seed is another, independent picture (default: 0)")->type_name("N");
  addRepeated(command, "--out", options.outputs, "picture to write; may be repeated. With --probe: FILE.csv", "FILE.exr|.png");
  command->add_option("--aov", options.aovs, "layers to write, each with its variance (default: all six)")->type_name("NAME[,NAME...]");
  command->add_option("--camera", options.camera, "camera of the scene (default: the first)")->type_name("NAME|INDEX");
  command->add_option("--size", options.size, "pixels (default: 960x540)")->type_name("WxH");
  command->add_option("--target-error", reference.targetError, "stop when color's expected relative error is at most X")->type_name("X");
  command->add_option("--time-limit", reference.timeLimit, "begin no pass that would end later")->type_name("SECONDS");
  command->add_option("--pass", reference.samplesPerPass, "samples a pixel that are stratified together (default: by --spp, at most 16)")
      ->type_name("N");
  command->add_flag("--halves", reference.halves, "also write FILE_a and FILE_b, from even and odd passes: independent of each other");
  command->add_option("--checkpoint", reference.checkpoint, "file to keep the state in: each minute, when interrupted, at the end")
      ->type_name("FILE");
  command->add_option("--resume", reference.resume, "go on from such a file")->type_name("FILE");
  command->add_option("--probe", reference.probe, "instead of a picture: irradiance at points, a line `x,y,z,nx,ny,nz` each")
      ->type_name("FILE.csv");
  command->add_option("--sides", reference.sides, "both (default), or gltf: back faces of single-sided materials are not there")
      ->type_name("NAME");
  command->add_option("--threads", reference.threads, "0 (default): all; the picture is the same for any number")->type_name("N");
  command->add_option("--stats", options.stats, "times, samples and errors to write")->type_name("FILE.json");
}

void addReportOptions(CLI::App* report, report::ReportOptions& reportOptions, Options& options) {
  report->add_option("SCENE", reportOptions.scenes, ".gltf or .glb files, or builtin:NAME[?key=value&...]")->type_name("")->take_all();
  addSkyOption(report, options);
  report->add_option("--out", reportOptions.out, "folder to write; what it holds already is not measured again")->type_name("DIR");
  report->add_option("--time-limit", reportOptions.timeLimit, "seconds for all (default: none)")->type_name("S");
  report->add_option("--size", reportOptions.size, "pixels (default: 640x360)")->type_name("WxH");
  report->add_option("--camera", options.camera, "camera of the scenes (default: the first)")->type_name("NAME|INDEX");
  report->add_option("--bounces", options.bounces, "indirect bounces of the truth (default: all)")->type_name("N|all");
  addRepeated(report, "--method", reportOptions.methods, "only this graph or preset; may be repeated", "NAME|FILE.json");
  addRepeated(report, "--set", options.sets, "one parameter of all methods; may be repeated", "node.param=value");
  report->add_option("--reference", reportOptions.reference, "truth, or two independent halves (default: the path tracer)")
      ->type_name("A.exr[,B.exr]");
  report->add_option("--weights", reportOptions.weights, "samples of the two halves (default: equal)")->type_name("WA,WB");
  report->add_option("--reference-error", reportOptions.referenceError, "relative noise at which the path tracer stops (default: 0.03)")
      ->type_name("E");
  report->add_option("--cache", reportOptions.cache, "folder of path-traced references (default: ~/.cache/radivox/references)")
      ->type_name("DIR");
  report->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  addRepeated(report, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
}

void addVdbOptions(CLI::App* command, Options& options, VdbOptions& vdb) {
  addSceneOptions(command, options);
  addRepeated(command, "--out", options.outputs, "OpenVDB or NanoVDB file to write", "FILE.vdb|.nvdb");
  command->add_option("--grids", vdb.grids, "what to write, or `help` for the list; only what it needs is computed (default: default)")
      ->type_name("NAME[,NAME...]");
  command
      ->add_option("--faces", vdb.faces, "of indirect and error: all voxel faces (default), or view: those that the camera's picture needs")
      ->type_name("all|view");
  command->add_option("--up", vdb.up, "y (default): axes as in the scene and in Houdini; z: as Blender turns glTF files")->type_name("y|z");
  addGraphOption(command, options, kFaceGraph);
  addRepeated(command, "--preset", options.presets, "settings to start from; may be repeated", "NAME|FILE.json");
  addRepeated(command, "--set", options.sets, "one parameter, as in voxelize.resolution=64; may be repeated", "node.param=value");
  command->add_option("--bounces", options.bounces, "indirect bounces: a number, or all (default), the converged solution")
      ->type_name("N|all");
  command->add_option("--camera", options.camera, "of --faces view (default: the first)")->type_name("NAME|INDEX");
  command->add_option("--size", options.size, "pixels of --faces view (default: 960x540)")->type_name("WxH");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  addRepeated(command, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
  command->add_option("--print", vdb.print, "instead: what a .vdb or .nvdb file holds")->type_name("FILE");
  command->add_option("--diff", vdb.diff, "instead: how two such files differ, grid by grid")->type_name("A B")->expected(2);
}

void addBenchOptions(CLI::App* command, Options& options, BenchOptions& bench) {
  command->add_option("SCENE", options.scene, "a .gltf or .glb file, or builtin:NAME[?key=value&...] (default: builtin:atrium)")
      ->type_name("");
  command->add_option("--rays", bench.rays, "about so many, from faces all over the scene (default: 1000000)")->type_name("N");
  command->add_option("--runs", bench.runs, "of each, whose median counts (default: 5)")->type_name("N");
  command->add_option("--threads", bench.threads, "of Embree; 0 (default): all, as CPU devices take")->type_name("N");
  addRepeated(command, "--out", options.outputs, "figures to write", "FILE.json");
  addGraphOption(command, options, kPictureGraph);
  addRepeated(command, "--preset", options.presets, "settings to start from; may be repeated", "NAME|FILE.json");
  addRepeated(command, "--set", options.sets, "one parameter, as in voxelize.resolution=128; may be repeated", "node.param=value");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  addRepeated(command, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
}

void addStabilityOptions(CLI::App* command, stability::SuiteOptions& suite, Options& options) {
  command->add_option("--out", suite.out, "folder for stability.html and stability.csv")->type_name("DIR");
  addRepeated(command, "--method", suite.methods, "only this graph; may be repeated (default: all that compute indirect light)",
              "NAME|FILE.json");
  command->add_option("--case", suite.match, "only cases with this in their name, as in 'stiff: furnace'")->type_name("TEXT");
  command->add_flag("--fast", suite.fast, "only the quick cases");
  command->add_option("--time-limit", suite.timeLimit, "begin no case after so many seconds")->type_name("S");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  command->add_flag("--validate", options.validate, "with Vulkan's validation layer; a message fails the case");
  addRepeated(command, "--module", options.modules, "a library with more nodes and cases; may be repeated", "FILE.so");
}

void addViewOptions(CLI::App* command, Options& options, viewer::ViewOptions& view) {
  addSceneOptions(command, options, " (default: builtin:atrium)");
  addGraphOption(command, options, kFaceGraph);
  addRepeated(command, "--preset", options.presets, "settings to start from; may be repeated", "NAME|FILE.json");
  addRepeated(command, "--set", options.sets, "one parameter; may be repeated", "node.param=value");
  command->add_option("--bounces", options.bounces, "indirect bounces: 0 is direct light only, all (default) the converged solution")
      ->type_name("N|all");
  command->add_option("--camera", options.camera, "camera of the scene (default: the first)")->type_name("NAME|INDEX");
  command->add_option("--overlay", view.overlay, "picture (default), voxels, clusters, ... or an AOV of the graph")->type_name("NAME");
  command->add_flag("--blocks", view.blocks, "overlays on the voxels themselves");
  command->add_option("--point", view.point, "the pixel that the mouse points at, for --overlay visible_clusters")->type_name("X,Y");
  command->add_option("--reference", view.reference, "stored picture, for --overlay error")->type_name("FILE.exr");
  command->add_flag("--truth", view.truth, "path-traced truth beside the picture");
  command->add_option("--views", view.views, "camera bookmarks, paths and lights; kept there, too (default: radivox_views.json)")
      ->type_name("FILE.json");
  command->add_option("--play", view.play, "begin with this path of --views")->type_name("NAME");
  command->add_option("--size", options.size, "pixels of the window, or of the picture without one (default: 1280x720)")->type_name("WxH");
  command->add_flag("--headless", view.headless, "no window: write pictures");
  addRepeated(command, "--out", options.outputs, "headless: picture to write, frame_####.png for every frame; may be repeated",
              "FILE.exr|.png");
  command->add_option("--frames", options.frames, "headless: how many frames, 30 a second (default: 1)")->type_name("N");
  command->add_flag("--panels", view.panels, "headless: the window's panels around the picture");
  command->add_option("--stats", options.stats, "times to write when it ends")->type_name("FILE.json");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
  addRepeated(command, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
  command->add_flag("--validate", options.validate, "with Vulkan's validation layer; its messages are errors");
}

/// Words that no option of the command took. CLI11's own report knows no nearest name.
void refuseExtras(const CLI::App& command, const std::string& what) {
  const std::vector<std::string> extras = command.remaining();
  if (extras.empty()) return;
  std::string extra = extras.front();
  if (extra.rfind("-", 0) != 0) {
    throw Error(ErrorCode::BadInput, "unexpected argument '" + extra + "'; see `radivox " + what + "--help`");
  }
  extra = extra.substr(0, extra.find('='));
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  // Without the dashes, which every option shares.
  const std::string near = params::nearestName(extra.substr(std::min(extra.find_first_not_of('-'), extra.size())), names);
  throw Error(ErrorCode::BadInput,
              "unknown option '" + extra + "'; " + (near.empty() ? "see `radivox " + what + "--help`" : "did you mean '--" + near + "'?"));
}

/// Of pictures that are only measured.
void addMeasuredOptions(CLI::App* command, Options& options) {
  addGraphOption(command, options, kPictureGraph, false);
  addRepeated(command, "--set", options.sets, "one parameter; may be repeated", "node.param=value");
  command->add_option("--bounces", options.bounces, "indirect bounces (default: all)")->type_name("N|all");
  command->add_option("--size", options.size, "pixels (default: 960x540)")->type_name("WxH");
  command->add_option("--device", options.device, "Vulkan device of `radivox info` (default: the best)")->type_name("N");
}

void requireScene(const Options& options, const std::string& name) {
  if (!options.scene.empty()) return;
  throw Error(ErrorCode::BadInput,
              "SCENE is missing; give a .gltf or .glb file or builtin:NAME, as in `radivox " + name + " builtin:atrium`");
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Voxel global illumination for Vulkan.", "radivox");
  app.set_version_flag("--version", std::string("radivox ") + RADIVOX_VERSION);
  app.require_subcommand(0, 1);
  app.allow_extras();
  app.footer(
      "Exit codes: 0 done, 2 bad usage or input, 3 the device cannot, 4 out of memory, 130 interrupted; 1 from stability: a case fails.");

  CLI::App* render = app.add_subcommand("render", "render a scene to .exr or .png");
  addPlanOptions(render, options);
  addRepeated(render, "--out", options.outputs, "picture to write; may be repeated", "FILE.exr|.png");
  render->add_option("--stats", options.stats, "times, memory and counts to write")->type_name("FILE.json");
  render->add_option("--frames", options.frames, "run the graph N times, nothing changed in between (default: 1)")->type_name("N");
  render
      ->add_option("--max-error", options.maxError,
                   "the fastest settings whose color errs by at most X of its mean (RMSE), measured on this scene")
      ->type_name("X");
  render
      ->add_option("--budget-ms", options.budgetMs, "the best settings that take at most T milliseconds a picture, measured on this scene")
      ->type_name("T");
  render->add_option("--calibration-time", options.calibrationTime, "seconds that these measurements may take, once (default: 120)")
      ->type_name("S");
  render->add_flag("--validate", options.validate, "with Vulkan's validation layer; its messages are errors");
  ReferenceOptions referenceOptions;
  CLI::App* reference = app.add_subcommand("reference", "path trace a scene: the truth, with the variance of every pixel");
  addReferenceOptions(reference, options, referenceOptions);
  CLI::App* compare = app.add_subcommand("compare", "how wrong a picture is: bias, RMSE, relMSE, PSNR, FLIP");
  compare->add_option("REF", options.reference, "a .exr or .png file, or two independent halves A.exr,B.exr")->type_name("");
  compare->add_option("TEST", options.test, "the picture to judge")->type_name("");
  compare->add_option("--layer", options.layer, "which layer of both (default: color)")->type_name("NAME");
  compare->add_option("--weights", options.weights, "samples of the two halves (default: equal)")->type_name("WA,WB");
  compare->add_option("--json", options.json, "the figures to write")->type_name("FILE.json");
  addRepeated(compare, "--out", options.outputs, "FLIP's error as colours (.png), or errors as layers (.exr)", "FILE.exr|.png");
  report::ReportOptions reportOptions;
  CLI::App* report = app.add_subcommand("report", "error against run time: every method and preset on these scenes, as report.html");
  addReportOptions(report, reportOptions, options);
  VdbOptions vdbOptions;
  CLI::App* vdb = app.add_subcommand("vdb", "write voxels, clusters and their light as OpenVDB or NanoVDB; print and compare such files");
  addVdbOptions(vdb, options, vdbOptions);
  stability::SuiteOptions suiteOptions;
  CLI::App* stability = app.add_subcommand("stability", "stiff and extreme cases, each against its known answer, as stability.html");
  addStabilityOptions(stability, suiteOptions, options);
  viewer::ViewOptions viewOptions;
  CLI::App* view = app.add_subcommand("view", "walk through a scene in a window, and look inside its light");
  addViewOptions(view, options, viewOptions);
  CLI::App* graph = app.add_subcommand("graph", "print the plan: order, what is left out and why, memory, barriers");
  addPlanOptions(graph, options);
  graph->add_option("--format", options.format, "text (default), dot or json")->type_name("NAME");
  std::vector<std::string> neededScenes;
  std::string neededRuns = "5";
  CLI::App* needs = app.add_subcommand("needs", "time and memory saved by leaving out what these scenes do not need, as a table");
  needs->add_option("SCENE", neededScenes, ".gltf or .glb files, or builtin:NAME[?key=value&...]")->type_name("")->take_all();
  needs->add_option("--runs", neededRuns, "pictures whose median counts (default: 5)")->type_name("N");
  addMeasuredOptions(needs, options);
  std::string shares = "1,10,50";
  CLI::App* moves =
      app.add_subcommand("moves", "what a picture costs after lights, camera or part of the scene have moved, beside one from scratch, as a table");
  addSceneOptions(moves, options);
  moves->add_option("--shares", shares, "triangles that move, percent (default: 1,10,50)")->type_name("N,N");
  addMeasuredOptions(moves, options);
  BenchOptions benchOptions;
  CLI::App* bench = app.add_subcommand("bench", "speed of voxel rays beside Embree's closest hits of the same rays, and how they agree");
  addBenchOptions(bench, options, benchOptions);
  CLI::App* scene = app.add_subcommand("scene", "write a scene as .glb: a built-in one, or a file flattened to what is lit");
  scene->add_option("NAME", options.scene, "a built-in scene of `radivox info`, as NAME[?key=value&...], or a .gltf/.glb file")
      ->type_name("");
  addRepeated(scene, "--out", options.outputs, "file to write", "FILE.glb");
  CLI::App* info = app.add_subcommand("info", "devices, node types and their parameters, scenes, graphs, presets");
  addRepeated(info, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
  CLI::App* nodes = app.add_subcommand("nodes", "every node as it describes itself: ports and parameters");
  addRepeated(nodes, "--module", options.modules, "a library with more nodes; may be repeated", "FILE.so");
  nodes->add_option("--format", options.format, "text (default) or markdown, all of it: docs/nodes.md")->type_name("NAME");
  const std::vector<std::string> commandNames = {"render", "reference", "compare", "report", "view",  "stability", "vdb",
                                                 "graph",  "needs",     "moves",   "bench",  "scene", "info",      "nodes"};
  for (CLI::App* command : {render, reference, compare, report, view, stability, vdb, graph, needs, moves, bench, scene, info, nodes})
    command->allow_extras();

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help, --version
  } catch (const CLI::ParseError& e) {
    throw Error(ErrorCode::BadInput, std::string(e.what()) + "; see `radivox --help`");
  }
  if (app.get_subcommands().empty()) {
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty() && extras.front().rfind("-", 0) != 0) failUnknown("command", extras.front(), commandNames);
    refuseExtras(app, "");
    throw Error(
        ErrorCode::BadInput,
        "a command is missing; give render, reference, compare, report, view, stability, vdb, graph, needs, moves, bench, scene, info or "
        "nodes, or see "
        "`radivox --help`");
  }
  const CLI::App* command = app.get_subcommands().front();
  refuseExtras(app, "");
  refuseExtras(*command, command->get_name() + " ");

  catchInterrupts();
  ignoreFileSizeSignal();
  if (command == info) return runInfo(options);
  if (command == nodes) return runNodes(options);
  if (command == compare) return runCompare(options);
  if (command == vdb && (!options.scene.empty() || vdbOptions.grids == "help" || !vdbOptions.print.empty() || !vdbOptions.diff.empty())) {
    return runVdb(options, vdbOptions);
  }
  if (command == needs && !neededScenes.empty()) return runNeeds(options, neededScenes, neededRuns);
  if (command == stability) return stability::runStability(suiteOptions, options);
  if (command == report && !reportOptions.scenes.empty()) return report::runReport(reportOptions, options);
  if (command == scene && options.scene.empty()) {
    throw Error(ErrorCode::BadInput,
                "NAME is missing; give a built-in scene of `radivox info`, as in `radivox scene cornell --out cornell.glb`");
  }
  if (command == moves && !options.scene.empty()) return runMoves(options, shares);
  if (command == bench) {
    if (options.scene.empty()) options.scene = "builtin:atrium";
    return runBench(options, benchOptions);
  }
  if (command == view) {
    if (view->count("--size") == 0) options.size = "1280x720";
    return viewer::runView(viewOptions, options);
  }
  requireScene(options, command->get_name());
  if (command == scene) return runScene(options);
  if (command == reference) {
    if (command->count("--aov") == 0) options.aovs.clear();
    return runReference(options, referenceOptions);
  }
  return command == graph ? runGraph(options) : runRender(options);
}

int runGuarded(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    // A full disk behind `>` shows only here.
    if (!std::cout.flush()) throw Error(ErrorCode::BadInput, "cannot write to standard output; redirect it to a file with room");
    return code;
  } catch (const Interrupted&) {
    printError("interrupted");
    return kInterruptedExitCode;
  } catch (const Error& e) {
    if (isInterrupted()) {
      printError("interrupted");
      return kInterruptedExitCode;
    }
    printError(e.what());
    return exitCodeOf(e.code());
  } catch (const std::bad_alloc&) {
    printError("out of memory on the host; choose a smaller scene, --size or voxelize.resolution");
    return exitCodeOf(ErrorCode::OutOfMemory);
  } catch (const std::exception& e) {
    printError(std::string("internal error: ") + e.what() + "; please report it with the command line");
    return kInternalErrorExitCode;
  }
}

}  // namespace

}  // namespace radivox::cli

int main(int argc, char** argv) { return radivox::cli::runGuarded(argc, argv); }
