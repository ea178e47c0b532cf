function varargout = roburoc4_mex(command, varargin) %#ok<STOUT,INUSD>
%ROBUROC4_MEX The connection to the C libraries; use roburoc4.Robot and roburoc4.Simulator instead.
%   The MEX file of this name, in the same folder, runs instead of this file. This file runs only if
%   the MEX file was not built:
%
%      build_mex          in MATLAB or Octave, in the folder bindings/matlab
%
%   Example:
%      roburoc4_mex('living')     % how many robots and simulators there are
%
%   See also roburoc4.Robot, roburoc4.Simulator.

% SPDX-License-Identifier: MIT
error('roburoc4:notBuilt', ['the MEX file is not built for this program. Run build_mex in the ' ...
    'folder bindings/matlab']);
end
