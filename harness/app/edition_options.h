#pragma once
#include "app/suite_options.h"
#include "measure/edition/edition.h"

namespace gnomon::app {

/// Options of `run` that name an edition.
struct EditionOptions {
  std::string edition;   ///< empty: none
  std::string division;  ///< empty: default
};

void add_edition_options(Command& command, EditionOptions& options);

/// The suite of an edition with what the other options may change of it, and the edition for run.json. Prints a line for each
/// edition_difference. Throws Error where there is one, on options that change the edition's rows, and on settings of the
/// default division.
std::pair<Suite, RunEdition> edition_to_run(const EditionOptions& edition, const SuiteOptions& options, SceneLibrary& library);

}  // namespace gnomon::app
