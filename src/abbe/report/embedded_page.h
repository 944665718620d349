/// The files of page/ and the plotting library as they were when the library was built.
#pragma once

namespace abbe {

/// The text of a file by its name; null for one that is not there.
const char* embedded_page_file(const char* name);

}  // namespace abbe
