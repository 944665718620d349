/// config/config.ocio as it was when the library was built.
#pragma once

namespace abbe {

const char* embedded_config();

}  // namespace abbe
