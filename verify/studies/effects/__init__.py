"""The study of effects: changes of the results and of the time by switching each of ``[effects]`` on and off."""
