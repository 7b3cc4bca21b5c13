// SPDX-License-Identifier: BSD-3-Clause
//
// Runs all sections of the report, or with --only NAME one of them, and writes their rows: polyscalpel_report
// --output report.json [options], each option followed by its value. `./run report` calls it.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>

#include "benchmark/machine.hpp"
#include "benchmark/report.hpp"

namespace polyscalpel::report {
namespace {

struct Section {
  std::string name;
  Rows (*study)(const Context&);
};

const std::vector<Section> kSections = {{"formulations", studyFormulations},
                                        {"cutting", studyCutting},
                                        {"cell_counts", studyCellCounts},
                                        {"integration", studyIntegration},
                                        {"stages", studyStages},
                                        {"peers", studyPeers},
                                        {"solvers", studySolvers},
                                        {"scaling", studyScaling},
                                        {"after_cuts", studyAfterCuts},
                                        {"limits", studyLimits},
                                        {"hard_cases", studyHardCases},
                                        {"hard_solvers", studyHardSolvers},
                                        {"torture", studyTorture}};

Mode parseMode(const std::string& name) {
  if (name == "quick") return Mode::kQuick;
  if (name == "default") return Mode::kDefault;
  if (name == "full") return Mode::kFull;
  throw std::invalid_argument("--mode " + name + ": must be quick, default or full");
}

/// Values by option; --version name=value may be given again and again.
struct Options {
  std::map<std::string, std::string> values = {{"output", ""},
                                               {"mode", "default"},
                                               {"commit", "unknown"},
                                               {"bunny", ""},
                                               {"bunny-note", "none was given"},
                                               {"only", ""}};
  Row versions = Row::object();
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    if (i + 1 == argc) throw std::invalid_argument(option + ": needs a value");
    const std::string value = argv[i + 1];
    const std::size_t equals = value.find('=');
    if (option == "--version" && equals != std::string::npos)
      options.versions[value.substr(0, equals)] = value.substr(equals + 1);
    else if (option.rfind("--", 0) == 0 && options.values.count(option.substr(2)) == 1)
      options.values[option.substr(2)] = value;
    else
      throw std::invalid_argument(option + " " + value + ": no such option");
  }
  if (options.values["output"].empty()) throw std::invalid_argument("--output must be given");
  return options;
}

int run(int argc, char** argv) {
  Options options = parse(argc, argv);
  Context context;
  context.mode = parseMode(options.values["mode"]);
  context.bunny_mesh = options.values["bunny"];
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  context.meshes_folder = folder ? folder : "";
  context.bunny_note = options.values["bunny-note"];
  const auto start = std::chrono::steady_clock::now();
  Progress progress(static_cast<int>(kSections.size()));
  context.progress = &progress;

  Row document;
  std::vector<std::string> broken;
  for (const Section& section : kSections) {
    Rows rows;
    if (options.values["only"].empty() || options.values["only"] == section.name) {
      try {
        rows = section.study(context);
      } catch (const std::exception& error) {
        // What other sections measured is not lost.
        Row row;
        holdFailed(row, error.what());
        rows.push_back(row);
      }
    }
    const std::vector<std::string> of_section = brokenRules(section.name, rows);
    broken.insert(broken.end(), of_section.begin(), of_section.end());
    document[section.name] = std::move(rows);
  }
  progress.finish();
  document["machine"] = describeMachine();
  document["commit"] = options.values["commit"];
  document["versions"] = options.versions;
  document["duration_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  document["mode"] = options.values["mode"];

  std::ofstream file(options.values["output"]);
  file << document.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error("cannot write " + options.values["output"]);
  for (const std::string& rule : broken) std::cerr << rule << '\n';
  return broken.empty() ? 0 : 1;
}

}  // namespace
}  // namespace polyscalpel::report

int main(int argc, char** argv) {
  try {
    return polyscalpel::report::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "polyscalpel_report: " << error.what() << '\n';
    return 2;
  }
}
