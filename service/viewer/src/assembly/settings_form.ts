// Numbers of the scene, each with what it is for.
import {element} from '../dom.js';
import type {Engine, Settings} from './draft.js';

export class SettingsForm {
  private readonly stiffness = element<HTMLInputElement>('set-stiffness');
  private readonly voxel = element<HTMLInputElement>('set-voxel');
  private readonly profile = element<HTMLSelectElement>('set-profile');
  private readonly law = element<HTMLSelectElement>('set-law');
  private readonly engine = element<HTMLSelectElement>('set-engine');
  private readonly budget = element<HTMLInputElement>('set-budget');

  constructor(changed: (settings: Settings) => void) {
    for (const field of [this.stiffness, this.voxel, this.profile, this.law, this.budget, this.engine])
      field.addEventListener('change', () => {
        if (!field.checkValidity()) {
          field.reportValidity();
          return;
        }
        changed({
          stiffness: this.stiffness.valueAsNumber || 2000,
          voxel_mm: this.voxel.value === '' ? null : this.voxel.valueAsNumber,
          profile: this.profile.value as Settings['profile'],
          law: this.law.value as Settings['law'],
          budget_us: Number.isFinite(this.budget.valueAsNumber) ? this.budget.valueAsNumber * 1000 : 4000,
          engine: this.engine.value as Engine,
        });
      });
  }
  show(settings: Settings): void {
    this.stiffness.value = String(settings.stiffness);
    this.voxel.value = settings.voxel_mm === null ? '' : String(settings.voxel_mm);
    this.profile.value = settings.profile;
    this.law.value = settings.law;
    this.engine.value = settings.engine;
    this.budget.value = String(settings.budget_us / 1000);
  }
}
