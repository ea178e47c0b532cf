function blocks = slblocks()
%SLBLOCKS Show the library in Simulink's Library Browser, which calls this file.
%   The library is made by roburoc4_library in a folder that is on the path.
%
%   Example:
%      roburoc4_library(); sl_refresh_customizations
%
%   See also roburoc4_library.

% SPDX-License-Identifier: MIT
blocks.Browser.Library = 'roburoc4_blocks';
blocks.Browser.Name = 'RobuROC4';
end
