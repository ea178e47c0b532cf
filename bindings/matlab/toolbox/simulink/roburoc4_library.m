function file = roburoc4_library(folder)
%ROBUROC4_LIBRARY Make a Simulink library with the block of a RobuROC4.
%   FILE = roburoc4_library() writes roburoc4_blocks.slx into the current folder;
%   roburoc4_library(FOLDER) writes it into another one. Where the folder is on the path, the Library
%   Browser shows it. It needs Simulink R2021a or newer, and has not been run there yet.
%
%   Example:
%      roburoc4_library(); open_system('roburoc4_blocks')
%
%   See also roburoc4.System, roburoc4_model.

% SPDX-License-Identifier: MIT
if nargin < 1
    folder = pwd;
end
name = 'roburoc4_blocks';
file = fullfile(folder, [name '.slx']);
load_system('simulink');
new_system(name, 'Library');
block = [name '/RobuROC4'];
add_block('simulink/User-Defined Functions/MATLAB System', block, 'Position', [40 40 220 180]);
set_param(block, 'System', 'roburoc4.System');
set_param(name, 'EnableLBRepository', 'on');
save_system(name, file);
close_system(name);
end
