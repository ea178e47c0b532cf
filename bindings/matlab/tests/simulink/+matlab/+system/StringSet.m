classdef StringSet < handle
%STRINGSET A stand-in for MATLAB's matlab.system.StringSet, for tests in Octave.
%
%   Example:
%      matlab.system.StringSet({'simulation', 'wall'})

% SPDX-License-Identifier: MIT
properties
    texts
end

methods
    function this = StringSet(texts)
        this.texts = texts;
    end
end
end
